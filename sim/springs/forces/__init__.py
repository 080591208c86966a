"""The forces on a net: one file each, discovered here, with everything the program knows of the force.

`each` generates the kernels that loop over all forces, as source with one call per force, when the program starts. The
list therefore costs nothing at run time.

To add a force, write a module in this folder with

1. a NamedTuple class of the force's numbers, all floats, with defaults. `Net.forces` holds one, and kernels take it as
   their first argument: a net without the force has kernels without it.
2. kernels for its facets, as `Force` lists them; none for a facet that it does not have. A force that depends on
   velocities leaves them out if `with_damping` is False, and has `damp` or `hold`, and `power`: leapfrog and the
   energy account know damping by these alone.
3. `FORCE = Force(...)`.

The forces without numbers of their own read those of the net's record. In ropes, cloths and other nets, links, gravity
and drag accelerate in the hand-written loops over links of `sim/springs/points/acceleration.py`. Lines under water are
nets with more forces, those of `under_water`: water, bed, bending, steady loads and the bodies that they hold. Their
damping has no `damp`, except friction: it is in the kick of `sim.springs.kicks.lines`.
"""

from collections import namedtuple
from collections.abc import Sequence
from typing import Any, NamedTuple

from sim.jit import chosen, generated, kernel, modules_of
from sim.springs.forces.record import Absent, Force
from sim.springs.forces.under_water import FORCES as UNDER_WATER
from sim.springs.points.arrays import GridArrays, RopeArrays, StrandArrays, by_net
from sim.springs.points.line_arrays import LineArrays
from sim.validation import argument_error, check_number

FORCES: tuple[Force, ...] = tuple(
    sorted(
        (*UNDER_WATER, *(module.FORCE for module in modules_of(__name__) if hasattr(module, "FORCE"))),
        key=lambda force: (force.rank, force.name),
    )
)
# Forces with numbers. A net has a record of these, so that its kernels hold only its own forces.
OWN = {force.numbers: force for force in FORCES if force.numbers is not None}
Declared = namedtuple("Declared", [force.name for force in OWN.values()], module=__name__)
there = kernel(lambda own: True, inline=True)
missing = kernel(lambda own: False, inline=True)


class Summation(NamedTuple):
    """Sums of the results of forces in a kernel of `each`."""

    start: str  # its first line
    call: str  # statement with the `call` of an acting force
    end: str  # its last line
    nothing: str  # result of a force that a net does not have


SUMMATIONS = {
    "none": Summation("pass", "{call}", "return None", "None"),
    "truth": Summation("pass", "return True", "return False", "False"),
    "sum": Summation("total = 0.0", "total += {call}", "return total", "0.0"),
    "stores": Summation(
        "elastic = gravity = contact = 0.0", "{stores} += {call}", "return elastic, gravity, contact", "0.0"
    ),
    "two sums": Summation(
        "first = second = 0.0", "one, other = {call}; first += one; second += other", "return first, second", "0.0, 0.0"
    ),
}


def each(
    facet: str,
    parameters: str,
    result: str,
    forces: Sequence[Force] = FORCES,
    *,
    having: str = "",
    turns: bool = False,
    **options: Any,
) -> Any:
    """A kernel of `parameters` that calls this facet of all acting forces that have it, or the facet `having`.

    result: a key of SUMMATIONS. turns: in the reverse order if the parameter `reverse` is True. options: of `kernel`.
    """
    sums = SUMMATIONS[result]

    def call(force: Force) -> str:
        own = f"p.forces.{force.name}, " if force.numbers else ""
        acts = f"{force.name}_is_there(p.forces.{force.name})" if force.numbers else force.acts
        done = sums.call.format(call=f"{force.name}_{facet}({own}{parameters})", stores=force.stores)
        return done if acts == "True" else f"if {acts}: {done}"

    def kernels(force: Force, net: type) -> dict[str, Any]:
        """Kernels by their names in `call`; of a force with numbers, the choice between it and nothing."""
        found = {} if facet == "acts" else {facet: force.facet(facet, net)}
        if force.numbers:
            for name, one in found.items():
                source = f"def no_{name}(own, {parameters}):\n    return {sums.nothing}"
                absent = generated(source, {}, __name__, inline=True)
                found[name] = chosen({force.numbers: one or absent, Absent: absent})
            found["is_there"] = chosen({force.numbers: there, Absent: missing})
        return {f"{force.name}_{name}": one for name, one in found.items()}

    def of(net: type, name: str) -> Any:
        acting = [one for one in forces if one.facet(having or facet, net) is not None]
        if len(acting) == 1 and acting[0].acts == "True" and not acting[0].numbers:
            return acting[0].facet(facet, net)
        calls = list(map(call, acting))
        if turns:
            order = [f"({len(calls) - 1 - at} if reverse else {at})" for at in range(len(calls))]
            calls = [f"    if turn == {at}:\n            {one}" for at, one in zip(order, calls, strict=True)]
            calls.insert(0, f"for turn in range({len(acting)}):")
        head = f"def {'_'.join((name, facet, *(force.name for force in acting)))}({parameters}):"
        names = {name: one for force in acting for name, one in kernels(force, net).items()}
        return generated("\n    ".join([head, sums.start, *calls, sums.end]), names, __name__, **options)

    return by_net(
        rope=of(RopeArrays, "rope"),
        grid=of(GridArrays, "wide"),
        lines=of(LineArrays, "lines"),
        strand=of(StrandArrays, "strand"),
    )


def check_forces(forces: Any) -> tuple[Any, ...]:
    """The numbers of the forces that a net declares, checked. Raises ValueError for others."""
    known = f"numbers of the forces of sim.springs.forces: {', '.join(one.__name__ for one in OWN) or 'none so far'}"
    if not isinstance(forces, tuple) or any(type(one) not in OWN for one in forces):
        raise argument_error("forces", forces, known)
    if len({type(one) for one in forces}) < len(forces):
        raise argument_error("forces", forces, "one of each force")
    for one in forces:
        for name, value in one._asdict().items():
            check_number(f"{OWN[type(one)].name}.{name}", value, "")
    return forces


def declared(forces: tuple[Any, ...]) -> Any:
    """The kernels' record of the forces that a net declares."""
    given = {type(one): type(one)(*map(float, one)) for one in forces}
    return Declared(*(given.get(numbers, Absent()) for numbers in OWN))
