"""Parts and entries: what a kernel becomes when kernels call it, and when Python does."""

import gc
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from sim import jit
from sim.compiler import with_room
from sim.jit import chosen, compile_ahead, kernel
from tests.fresh import python

with pytest.MonkeyPatch.context() as patch:
    patch.setattr(jit, "CACHE", None)
    # It remembers the answer: the kernels of this file are not kept, and each run of the tests compiles them.
    jit.kernel_folder(Path(__file__).resolve())

pytestmark = pytest.mark.filterwarnings("ignore:no folder for kernels is writable")


class Round(NamedTuple):
    radius: float


class Square(NamedTuple):
    side: float


@kernel
def round_area(shape, scale):
    return scale * 3.0 * shape.radius**2


@kernel
def square_area(shape, scale):
    return scale * shape.side**2


area = chosen({Round: round_area, Square: square_area})


@kernel
def double_area(shape):
    return area(shape, 2.0)


@kernel
def signed(x, negative):
    return -x if negative else x


@kernel
def both_signs(x):
    return signed(x, True) + 2.0 * signed(x, False)


@kernel(inline=True)
def with_length(x):
    return x, x.shape[0]


@kernel(allocates=False)
def first(x):
    return with_length(x)[0][0]


@kernel
def shifted(x, steps, up):
    return x + steps if up else x - steps


@kernel
def all_shifted(x):
    return shifted(x, 1, True) + shifted(x, 2, False) - shifted(0.0, 2, True) - shifted(0.0, 0, True)


@kernel
def third_of(x, i):
    if i > 2:
        raise ValueError("there are three")
    return x[i]


@kernel
def last_of(x, i):
    return third_of(x, i)


def compiled_parts(function: Any) -> int:
    return len(function.part.overloads)


def test_a_kernel_that_only_kernels_call_is_no_machine_code_of_its_own():
    assert both_signs(3.0) == 3.0
    assert len(both_signs.signatures) == 1
    assert not signed.signatures
    (part,) = signed.part.overloads.values()
    assert part.library.get_pointer_to_function(part.fndesc.llvm_func_name) == 0
    assert signed(3.0, True) == -3.0  # Python may call it all the same
    assert len(signed.signatures) == 1


def test_constant_arguments_make_no_further_parts():
    assert all_shifted(3.0) == 3.0
    assert compiled_parts(shifted) == 1


def test_what_is_compiled_ahead_is_what_callers_find():
    """Of plain numbers, of a record, and of a result."""
    aside = kernel(signed.py_func)
    side = compile_ahead(aside, 3.0, True)
    assert compile_ahead(area, Square(3.0), side) == side == compile_ahead(aside, side, False)
    assert compiled_parts(aside) == compiled_parts(square_area) == 1
    assert not aside.signatures
    assert double_area(Square(3.0)) == 18.0
    assert compiled_parts(square_area) == 1


def test_no_garbage_is_looked_for_while_a_kernel_is_compiled():
    """Only afterwards, at the first chance, and after a failure too."""
    one, other, fails, rounds = kernel(shifted.py_func), kernel(shifted.py_func), kernel(first.py_func), []
    gc.collect()
    gc.callbacks.append(count := lambda phase, _: rounds.append(phase) if phase == "start" else None)
    try:
        one(1.0, 2, True)
        compile_ahead(other, 1.0, 2, True)
        during = len(rounds)
    finally:
        gc.callbacks.remove(count)
    assert during <= 2
    assert gc.isenabled()
    with pytest.raises(TypeError):
        fails(np.ones(3))
    assert gc.isenabled()


def test_the_type_of_a_record_chooses_the_kernel_and_the_others_are_not_compiled():
    assert double_area(Square(3.0)) == 18.0
    assert compiled_parts(square_area) == 1
    assert compiled_parts(round_area) == 0
    assert double_area(Round(1.0)) == 6.0
    assert area(Round(2.0), 1.0) == 12.0
    with pytest.raises(TypeError, match="no kernel for"):
        double_area((1.0, 2.0))


def test_a_kernel_that_was_chosen_once_is_found_at_once(monkeypatch):
    """From Python too: to choose among types takes as long as thirty calls of a short kernel."""
    assert area(Square(3.0), 1.0) == 9.0
    monkeypatch.setattr(type(area), "variant", None)
    assert area(Square(2.0), 1.0) == 4.0


RAISES = """
import numpy as np, tests.sim.test_compiler as t
try:
    t.last_of(np.zeros(3), 5)
except ValueError as error:
    print(error, t.last_of(np.ones(3), 1))
"""


def test_a_kept_kernel_raises_as_a_new_one_does(tmp_path):
    """Compiled again, from kept parts, and kept itself."""
    said = [python(RAISES, SPRINGTIDE_CACHE=str(tmp_path)) for _ in range(2)]
    for path in tmp_path.rglob("*last_of*.nb?"):
        path.unlink()
    said.append(python(RAISES, SPRINGTIDE_CACHE=str(tmp_path)))
    assert said == ["there are three 1.0"] * 3


def test_kernels_run_interpreted():
    code = "import tests.sim.test_compiler as t; print(t.double_area(t.Square(3.0)), t.both_signs(3.0))"
    assert python(code, NUMBA_DISABLE_JIT="1") == "18.0 3.0"


def test_a_kernel_with_other_options_has_other_files():
    names = {jit.kernel(signed.py_func, **options).file_name for options in ({}, {"noalias": True}, {"inline": True})}
    assert len(names | {signed.file_name}) == 3


def test_a_kernel_that_counts_calls_none_that_returns_what_it_did_not_count():
    with pytest.raises(TypeError, match=r"^with_length returns an array: .* needs allocates=False$"):
        kernel(first.py_func)(np.ones(3))
    assert first(np.full(3, 2.0)) == 2.0


@pytest.mark.stress  # compiles the forces on a cloth; that threads start from a kept kernel is in test_jit
def test_a_parallel_part_of_a_kept_entry_runs(tmp_path):
    code = """
import numpy as np
from sim.springs import cloth
from sim.springs.points.acceleration import set_acceleration
import dataclasses
net = dataclasses.replace(cloth(16, 16), threads=2)
a = np.zeros(net.x0.size)
set_acceleration(net.x0.reshape(-1), np.zeros(net.x0.size), 0.0, net.kernel_view(1.0), a)
print(round(float(a.sum())))
"""
    first = python(code, SPRINGTIDE_CACHE=str(tmp_path))
    assert python(code, SPRINGTIDE_CACHE=str(tmp_path)) == first
    assert first == str(round(-9.81 * (16 * 16 - 2)))


def test_calls_at_any_depth_map_no_memory():
    resource = pytest.importorskip("resource")

    def faults_at(depth: int) -> int:
        """New pages of memory while functions are called from this depth."""
        if depth > 0:
            return faults_at(depth - 1)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
        for _ in range(1000):
            nothing()
        return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before

    def nothing() -> None:
        pass

    assert with_room(lambda: max(faults_at(depth) for depth in range(400))) < 500
