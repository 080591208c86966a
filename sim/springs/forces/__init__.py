"""The forces on a net: one file each, found by being here, with all that the program knows of the force.

A file declares `FORCE = Force(...)`, see `record.py`. `each` writes the kernels that go through the list of forces when
the program starts, a call a force: so a list costs no more than the calls written by hand.
"""

from collections.abc import Sequence
from typing import Any

from sim.jit import generated, modules_of
from sim.springs.arrays import GridArrays, RopeArrays, by_net
from sim.springs.forces.record import Force

FORCES: tuple[Force, ...] = tuple(
    sorted(
        (module.FORCE for module in modules_of(__name__) if hasattr(module, "FORCE")),
        key=lambda force: (force.rank, force.name),
    )
)
# Those that are not in the loops over the links.
SEPARATE = tuple(force for force in FORCES if force.accelerate is not None)
# What a kernel of `each` begins with, does with the call of a force that acts, and ends with.
RESULTS = {
    "none": ("", "{call}", "return None"),
    "truth": ("", "return True", "return False"),
    "sum": ("total = 0.0", "total += {call}", "return total"),
    "count": ("total = 0", "total += {call}", "return total"),
    "placed": ("o = 0", "{call}; o += {name}_coupled_size(p)", "return None"),
    "two sums": ("first = second = 0.0", "one, other = {call}; first += one; second += other", "return first, second"),
}


def each(
    facet: str,
    parameters: str,
    result: str,
    forces: Sequence[Force] = FORCES,
    *,
    turns: bool = False,
    lines: Any = None,
    **options: Any,
) -> Any:
    """A kernel of `parameters` that calls this facet of all forces that have it and act.

    result: a key of RESULTS. turns: in the reverse order if the parameter `reverse` is True. lines: the kernel of lines
    under water. options: of `kernel`.
    """
    start, middle, end = RESULTS[result]
    given = f"{parameters}, o" if result == "placed" else parameters

    def call(force: Force) -> str:
        guard = f"if {force.name}_acts(p): " if force.acts else ""
        return guard + middle.format(call=f"{force.name}_{facet}({given})", name=force.name)

    def of(net: type, name: str) -> Any:
        having = [force for force in forces if getattr(force, facet) is not None and net in force.nets]
        calls = list(map(call, having))
        if turns and len(calls) > 1:
            indented = [f"    {one}" for one in calls]
            calls = ["if reverse:", *reversed(indented), "else:", *indented]
        head = f"def {'_'.join((name, facet, *(force.name for force in having)))}({parameters}):"
        used = (facet, "acts", "coupled_size")
        names = {f"{force.name}_{one}": getattr(force, one) for force in having for one in used}
        return generated("\n    ".join([head, start, *calls, end]), names, __name__, **options)

    return by_net(rope=of(RopeArrays, "rope"), grid=of(GridArrays, "wide"), lines=lines)
