"""`Force`: the declaration of a force, one in a file of `sim.springs.forces`."""

from collections.abc import Callable
from typing import Any, NamedTuple

from sim.springs.points.arrays import ClothArrays, GridArrays, RopeArrays, StrandArrays
from sim.springs.points.line_arrays import LineArrays

WIDE_NETS = (GridArrays, ClothArrays)  # nets of several rows
CHAINS = (RopeArrays, StrandArrays)
SPRING_NETS = (*CHAINS, *WIDE_NETS)
LINES = (LineArrays,)  # lines under water
NETS = (*SPRING_NETS, *LINES)


def of_nets(springs: Any = None, lines: Any = None) -> dict[type, Any]:
    """A facet whose kernel for lines under water differs from that for ropes, cloths and other nets, or is missing."""
    return {**dict.fromkeys(SPRING_NETS, springs), **dict.fromkeys(LINES, lines)}


def no_bound(numbers: Any) -> tuple[float, float]:
    """No bound of a constant force."""
    return 0.0, 0.0


class Absent(NamedTuple):
    """Placeholder for the numbers of a force that a net does not have."""


class Force(NamedTuple):
    """A force on the points of a net. Facets are kernels; None: the force has none.

    x, v: positions [m] and velocities [m/s], flat (3 rows cols,), at the time t [s]; p: the net's record, see
    `sim.springs.points.arrays`, which has `point_count`, `is_moving` and `push` for points of every net. The facets of
    a force with numbers of its own take these before all else; `Net.forces` and `System.forces` have them.
    """

    name: str
    rank: int = 100  # forces act in the order of their ranks; those of one rank by name
    numbers: type | None = None  # NamedTuple of floats, with their defaults
    acts: str = "True"  # condition on p: no facet is called otherwise. Of a force with numbers: that a net has them
    # (x, v, t, p, with_damping, f, a): adds to a by `push`; f: scratch of `make_scratch`. None: part of the loops over
    # the links.
    accelerate: Any = None
    # (x, v, t, s, p, reverse): its damping alone for a time s [s] -> work [J] put in; of lines by the masses and
    # impulses of `sim.springs.points.line_points`
    damp: Any = None
    # (x, v, t, s, p, foreseen): its impulses in a time s [s] that stop points against all other forces, which come
    # before it -> work [J] put in. foreseen: after (x, v, t, p) of `foresee` before those forces.
    hold: Any = None
    foresee: Any = None
    energy: Any = None  # (x, t, p) -> stored energy [J]
    power: Any = None  # (x, v, t, p, with_damping) -> (dissipated, put in) [W]
    pins_power: Any = None  # (x, v, t, p) -> power that moving pins put in through its damping [W]
    tangent: Any = None  # (x, u, t, p, part, longest, out): adds a matrix times u, see `sim.springs.forces.matrices`
    blocks: Any = None  # (x, v, t, g, p, points): adds g D + g^2 K of each point, see `sim.springs.forces.matrices`
    # (x, v, t, g, p, pairs): of a rope, adds g D + g^2 K between the ends of each link, at its first one, symmetric
    pair_blocks: Any = None
    # Of a force with numbers, a function of these: most stiffness [N/m] and damping [N s/m] at any point.
    bound: Callable[[Any], tuple[float, float]] = no_bound
    stores: str = "gravity"  # field of `Energy` that its energy counts in
    is_smooth: bool = False  # its derivatives are continuous
    nets: tuple[type, ...] = NETS  # records of the nets that it acts on

    def facet(self, name: str, net: type) -> Any:
        """The kernel of a facet for a net's record; None if it has none."""
        found = getattr(self, name)
        return None if net not in self.nets else found.get(net) if isinstance(found, dict) else found
