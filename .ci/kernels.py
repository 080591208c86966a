"""The wheel of `springtide-kernels`, compiled kernels for one Python, numba and platform; a count of what it lacks.

    python .ci/kernels.py FOLDER OUT    write the wheel of what `springtide warmup --into FOLDER` has made to OUT
    python .ci/kernels.py --count       open each scene with an empty cache; status 1 if a kernel is compiled

The Python that runs this has the springtide that the kernels are for. Kernels are used wherever this numba is, so the
wheel has the tags of numba's own. Only what Python calls is in it, as callers have their callees inside.
"""

import base64
import hashlib
import os
import subprocess
import sys
import tempfile
import zipfile
from importlib.metadata import distribution, version
from pathlib import Path

from app.scenes import NAMES
from sim.cache import PACKAGE

MAX_SIZE = 4e6  # [bytes] of a wheel
SHOW = """
import sys
from app.server.viewer import Viewer
viewer = Viewer("127.0.0.1", 0)
viewer.open(sys.argv[1])
viewer.served.stop_threads()
viewer.loop.run.audience = lambda: 1
for _ in range(20):
    viewer.loop.tick(1 / 60)
    viewer.served.show_latest()
assert viewer.loop.run.counts["steps"] >= 20, viewer.loop.run.halted
viewer.shut()
"""


def contents(folder: Path) -> dict[str, bytes]:
    """The files of the wheel but for its metadata: path -> content."""
    files = {"__init__.py": b'"""Compiled kernels of Springtide."""\n'}
    for path in sorted(folder.rglob("*")):
        if path.is_file() and "-part." not in path.name and path.suffix in (".nbc", ".nbi", ".warm", ".json"):
            files[path.relative_to(folder).as_posix()] = path.read_bytes()
        elif path.name.startswith("compiler-"):
            files[path.relative_to(folder).as_posix()] = b""
    return {f"{PACKAGE}/{name}": content for name, content in files.items()}


def metadata(number: str) -> dict[str, bytes]:
    """Files that describe the distribution of this version."""
    tags = [line for line in (distribution("numba").read_text("WHEEL") or "").splitlines() if line.startswith("Tag:")]
    about = [
        "Metadata-Version: 2.1",
        "Name: springtide-kernels",
        f"Version: {number}",
        "Summary: Compiled kernels of springtide, for one Python, numba and platform",
        "License: MIT",
        f"Requires-Dist: springtide=={number}",
        *(f"Requires-Dist: {name}=={version(name)}" for name in ("numba", "llvmlite")),
    ]
    wheel = ["Wheel-Version: 1.0", "Generator: .ci/kernels.py", "Root-Is-Purelib: false", *tags]
    return {"METADATA": "\n".join([*about, ""]).encode(), "WHEEL": "\n".join([*wheel, ""]).encode()}


def file_tag(wheel: bytes) -> str:
    """The tag in the name of a wheel, of those in its description."""
    pythons, abis, platforms = zip(
        *(line.split()[1].split("-") for line in wheel.decode().splitlines() if line.startswith("Tag:")), strict=True
    )
    return "-".join(".".join(dict.fromkeys(parts)) for parts in (pythons, abis, platforms))


def write_wheel(folder: Path, out: Path) -> Path:
    """The wheel of the kernels in a folder, written to the folder `out`. Raises ValueError if it would be too large."""
    number = version("springtide")
    about = metadata(number)
    where = f"{PACKAGE}-{number}.dist-info"
    files = {**contents(folder), **{f"{where}/{name}": content for name, content in about.items()}}
    rows = []
    for name, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        rows.append(f"{name},sha256={digest},{len(content)}\n")
    files[f"{where}/RECORD"] = "".join([*rows, f"{where}/RECORD,,\n"]).encode()
    out.mkdir(parents=True, exist_ok=True)
    path = out / f"{PACKAGE}-{number}-{file_tag(about['WHEEL'])}.whl"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    if path.stat().st_size > MAX_SIZE:
        raise ValueError(f"{path.name} has {path.stat().st_size} bytes, more than {MAX_SIZE:.0f}")
    return path


def compiled(scene: str) -> list[str]:
    """Names of the files of kernels that are compiled until a scene has been shown for 20 steps."""
    with tempfile.TemporaryDirectory() as own:
        environment = {**os.environ, "SPRINGTIDE_CACHE": own}
        subprocess.run([sys.executable, "-c", SHOW, scene], env=environment, check=True)
        return [path.name for path in Path(own).rglob("*.nbc")]


def main() -> int:
    """See the top of this file."""
    if sys.argv[1:] == ["--count"]:
        found = {scene: compiled(scene) for scene in NAMES}
        for scene, names in found.items():
            print(f"{scene}: {len(names)} kernels compiled {' '.join(names)}")
        return int(any(found.values()))
    folder, out = map(Path, sys.argv[1:])
    path = write_wheel(folder, out)
    print(f"{path.name}: {path.stat().st_size / 1e6:.2f} MB, {len(list(folder.rglob('*.nbc')))} files of machine code")
    return 0


if __name__ == "__main__":
    sys.exit(main())
