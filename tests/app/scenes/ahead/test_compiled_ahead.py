"""After the warm-up no kernel is compiled: a new signature would stop the page for 0.1 s or more."""

import runpy
import subprocess
import sys
from pathlib import Path

import pytest

from tests.fresh import python

ROOT = Path(__file__).parents[4]
SIGNATURES = """
import sys
from numba.core.dispatcher import Dispatcher

def signatures():
    kernels = {id(k): k for m in list(sys.modules.values()) for k in vars(m).values() if isinstance(k, Dispatcher)}
    return {(k.py_func.__module__, k.py_func.__name__, str(s)) for k in kernels.values() for s in k.signatures}
"""
# How the wheel of kernels is checked.
SHOW = runpy.run_path(str(ROOT / ".ci" / "kernels.py"))["SHOW"]
# In a process of its own, as other tests compile other signatures.
PROGRAM = f"""{SIGNATURES}
from app.scenes.ahead.compiling import all_jobs, compile_job

for job in all_jobs(sys.argv[1]):
    compile_job(job)
before = signatures()
{SHOW}
print(sorted(signatures() - before))
"""

# Presets that need few pieces come first: what these compile is known before the others add to it.
PRESETS = (
    SIGNATURES
    + """
from app.scenes import scene_named
from app.scenes.ahead.compiling import Job, compile_job
from sim.parameters import check_record

kind = scene_named(sys.argv[1])
records = {preset: check_record(kind.params, values) for preset, values in kind.presets.items()}
for preset in sorted(records, key=lambda preset: len(kind.needs(records[preset]))):
    for piece in kind.needs(records[preset]):
        compile_job(Job(kind.name, piece))
    before = signatures()
    scene = kind.make(records[preset])
    for _ in range(5):
        scene.advance(2)
        scene.frame()
        scene.readings()
        scene.curves()
    new = sorted(signatures() - before)
    assert not new, (preset, new)
"""
)

# With an empty cache. The number of parts that are compiled for kicks, and those that the method compiles again.
TWICE = """
from numba.core import event
from app.scenes.springs.warmup import compile_kicks, integrator_pieces
from sim.compiler import Part
from sim.springs import rope

class Compiled(event.Listener):
    def __init__(self):
        self.parts = []

    def on_start(self, event):
        if isinstance(event.data["dispatcher"], Part):
            function = event.data["dispatcher"].py_func
            self.parts.append((function.__module__, function.__qualname__, str(event.data["args"])))

    def on_end(self, event):
        pass

net, compiled = rope(4), Compiled()
event.register("numba:compile", compiled)
compile_kicks(net)
count = len(compiled.parts)
integrator_pieces(net, net)["leapfrog"]()
print(count, *{name for _, name, _ in {*compiled.parts[:count]} & {*compiled.parts[count:]}})
print("sim.springs.kicks.kick kick_whole" in {f"{module} {name}" for module, name, _ in compiled.parts[:count]})
"""

# With an empty cache: what is loaded has no signatures of what it calls.
BEFORE_THE_FIRST_FRAME = f"""{SIGNATURES}
from app.scenes.ahead.compiling import compile_job, uncompiled
from app.scenes.cloth.parameters import ClothParams

for job in uncompiled("cloth", ClothParams()):
    compile_job(job)
print(*sorted({{module for module, _, _ in signatures()}}))
"""


@pytest.mark.long  # compiles with an empty cache
def test_kicks_that_are_compiled_apart_are_those_of_their_method(tmp_path: Path) -> None:
    parts, has_kick = python(TWICE, SPRINGTIDE_CACHE=str(tmp_path)).splitlines()
    count, *twice = parts.split()
    assert int(count) > 50
    assert has_kick == "True"
    assert twice == []


@pytest.mark.long  # compiles with an empty cache
def test_a_cloth_with_an_explicit_method_waits_for_no_implicit_solver(tmp_path: Path) -> None:
    modules = python(BEFORE_THE_FIRST_FRAME, SPRINGTIDE_CACHE=str(tmp_path)).splitlines()[-1].split()
    assert "sim.springs.integrators.leapfrog" in modules
    implicit = [module for module in modules if module.startswith("sim.springs.integrators.implicit")]
    assert implicit == ["sim.springs.integrators.implicit.tangent"]  # of the critical step


@pytest.mark.long  # compiles or loads all kernels of a scene in a process of its own
def test_each_preset_of_the_radial_sea_runs_with_what_it_says_it_needs() -> None:
    done = subprocess.run(
        [sys.executable, "-c", PRESETS, "radial_sea"], cwd=ROOT, capture_output=True, encoding="locale", timeout=300
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.long  # compiles or loads all kernels of a scene in a process of its own
@pytest.mark.parametrize(
    "name", ["cloth", *(pytest.param(name, marks=pytest.mark.stress) for name in ("rope", "race"))]
)
def test_no_kernel_is_compiled_after_the_warm_up(name: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, name], cwd=ROOT, capture_output=True, encoding="locale", timeout=300
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "[]"
