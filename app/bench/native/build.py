"""Build the C loops that our kernels are compared with."""

import ctypes
import importlib.resources
import shutil
import subprocess
import tempfile
from pathlib import Path

FLAGS = ("-O3", "-march=native", "-ffast-math", "-shared", "-fPIC")


def build(name: str) -> ctypes.CDLL | None:
    """Compile `name`.c of this folder and load it; None where there is no C compiler."""
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        return None
    source = importlib.resources.files("app.bench.native").joinpath(f"{name}.c").read_text()
    folder = Path(tempfile.mkdtemp(prefix="springtide-"))
    try:
        (folder / f"{name}.c").write_text(source)
        subprocess.run([compiler, *FLAGS, f"{name}.c", "-o", f"{name}.so", "-lm"], cwd=folder, check=True)
        return ctypes.CDLL(str(folder / f"{name}.so"))
    finally:
        shutil.rmtree(folder)
