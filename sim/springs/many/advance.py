"""`advance_many`: ropes of equally many points from rest to given numbers of steps, `WIDTH` of them at a time."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.interruption import raise_if_stopped
from sim.springs.analysis.extremes import DIVERGENCE_BOUND
from sim.springs.integrators import integrator_named
from sim.springs.many import kernels
from sim.springs.many.lanes import WIDTH, LaneForces, LaneState, by_rope, pack
from sim.springs.net import Net
from sim.springs.state import POINT_EVALS, State, check_net
from sim.validation import argument_error, check_choice, check_number

# The methods that have a kernel here, by the name of the integrator.
METHODS: dict[str, Callable[[LaneForces, LaneState, int, int], None]] = {
    "explicit_euler": kernels.take_explicit_euler_steps,
    "symplectic_euler": kernels.take_symplectic_euler_steps,
    "leapfrog": kernels.take_leapfrog_steps,
    "rk4": kernels.take_rk4_steps,
}
MOST_SAMPLED_STEPS = 2**53  # a number of steps up to which a time can be told from the next


class ManyStates(NamedTuple):
    """Sampled states of many ropes, each array by (rope, sample) first."""

    x: NDArray[np.float64]  # (ropes, samples, 3, 1, points) [m]
    v: NDArray[np.float64]  # (ropes, samples, 3, 1, points) [m/s]
    t: NDArray[np.float64]  # (ropes, samples) [s]
    steps: NDArray[np.int64]  # (ropes, samples) taken so far
    dissipated: NDArray[np.float64]  # (ropes, samples) [J] what damping took so far
    low: NDArray[np.float64]  # (ropes, samples, 3) [m] smallest x, y, z so far at which forces were evaluated
    high: NDArray[np.float64]  # (ropes, samples, 3) [m] largest
    diverged: NDArray[np.bool_]  # (ropes, samples) whether the rope has left any sane bound before this sample

    def state(self, rope: int, sample: int) -> State:
        """A copy of one sample as the `State` of its net, to go on from or to measure."""
        at = rope, sample
        state = State(self.x[at].copy(), self.v[at].copy(), float(self.t[at]), steps=int(self.steps[at]))
        state.dissipated = float(self.dissipated[at])
        return state


def is_plain(net: Net) -> bool:
    """Whether `advance_many` takes this net: a rope in empty space, damped isotropically, its pins at rest."""
    surroundings = net.floor, net.sphere, net.grab, net.air
    return (
        net.is_rope
        and net.damping_model == "isotropic"
        and all(thing is None for thing in surroundings)
        and not net.pin_paths
        and net.thickness == 0.0
    )


def advance_many(
    nets: Sequence[Net], integrator: str, h: Sequence[float] | NDArray[np.float64], samples: Any
) -> ManyStates:
    """Advance every rope of `nets` from rest by its own step, and sample its state after given numbers of steps.

    nets: ropes of equally many points that `is_plain` holds of; stiffness, rest length, damping, mass, drag, gravity,
    pins and start may differ. integrator: a name in `METHODS`. h: (ropes,) step of each [s]. samples: (ropes, samples)
    whole numbers of steps, none smaller than the one before it.

    Each rope moves as `sim.springs.advance` with_account moves it alone. The sums are taken in another order, so that
    the two differ by round-off. A rope that diverges changes no other one; `diverged` says so, and from that sample on
    its numbers are as they came.

    Raises ValueError, naming the argument, its value and what is allowed.
    """
    check_choice("integrator", integrator, METHODS)
    nets = list(nets)
    if not nets:
        raise argument_error("nets", nets, "at least one rope")
    for index, net in enumerate(nets):
        check_net(net)
        if not is_plain(net):
            allowed = "ropes with isotropic damping, without contact, air, grab or moving pins"
            raise argument_error(f"nets[{index}]", net.shape, allowed)
        if net.x0.shape != nets[0].x0.shape:
            raise argument_error("nets", f"{net.x0.shape[2]} points", f"{nets[0].x0.shape[2]} points, as the first has")
    if len(h) != len(nets):
        raise argument_error("h", f"{len(h)} steps", f"{len(nets)}, one for each rope")
    steps_of = np.array([check_number("h", step, 0, np.inf, "s", above=True) for step in h])
    counts = check_samples(samples, len(nets))
    shape, frames = nets[0].x0.shape, counts.shape[1]
    found = ManyStates(
        x=np.empty((*counts.shape, *shape)),
        v=np.empty((*counts.shape, *shape)),
        t=counts.astype(np.float64) * steps_of[:, None],
        steps=counts,
        dissipated=np.empty(counts.shape),
        low=np.empty((*counts.shape, 3)),
        high=np.empty((*counts.shape, 3)),
        diverged=np.zeros(counts.shape, np.bool_),
    )
    evals = integrator_named(integrator).evals
    most = max(1, int(POINT_EVALS / (shape[2] * WIDTH * evals)))
    # Ropes of about as many steps side by side: a lane that has given its samples goes on until the last one has.
    order = np.argsort(counts[:, frames - 1], kind="stable")
    lanes = np.concatenate([order, np.repeat(order[:1], -len(order) % WIDTH)])  # an empty lane repeats the first rope
    packed = pack([nets[rope] for rope in lanes], steps_of[lanes])
    for group, (forces, state) in enumerate(packed):
        ropes = order[group * WIDTH : (group + 1) * WIDTH]
        advance_group(METHODS[integrator], forces, state, ropes, most, found)
    outside = np.maximum(np.abs(found.low), np.abs(found.high)).max(axis=2)
    total = np.abs(found.x).sum(axis=(2, 3, 4)) + np.abs(found.v).sum(axis=(2, 3, 4))
    found.diverged[:] = ~((outside < DIVERGENCE_BOUND) & np.isfinite(total))
    return found


def check_samples(samples: Any, ropes: int) -> NDArray[np.int64]:
    """`samples` as an array. Raises ValueError for another shape, or for what are no numbers of steps."""
    allowed = f"rising whole numbers from 0 of shape ({ropes}, samples)"
    counts = np.asarray(samples)
    if counts.ndim != 2 or counts.shape[0] != ropes or counts.shape[1] == 0:
        raise argument_error("samples", counts.shape, allowed)
    if counts.dtype.kind not in "iu":
        raise argument_error("samples", str(counts.dtype), allowed)
    rising = np.diff(counts.astype(np.int64), axis=1, prepend=0)
    if counts.max() > MOST_SAMPLED_STEPS or rising.min() < 0:
        raise argument_error("samples", counts[np.argmin(rising.min(axis=1))].tolist(), allowed)
    return counts.astype(np.int64)


def advance_group(
    take_steps: Callable[[LaneForces, LaneState, int, int], None],
    forces: LaneForces,
    state: LaneState,
    ropes: NDArray[np.intp],
    most: int,
    found: ManyStates,
) -> None:
    """Advance up to WIDTH ropes, whose numbers are `ropes`, and write their samples into `found`.

    most: steps in one call of a kernel, which a Ctrl-C waits for.
    """
    events: dict[int, list[tuple[int, int]]] = {}  # number of steps -> (lane, sample) to be taken there
    for lane, rope in enumerate(ropes):
        for sample, count in enumerate(found.steps[rope].tolist()):
            events.setdefault(count, []).append((lane, sample))
    taken = 0
    for count in sorted(events):
        while taken < count:
            raise_if_stopped()
            steps = min(most, count - taken)
            take_steps(forces, state, taken, steps)
            taken += steps
        in_lanes, at_samples = (np.array(numbers) for numbers in zip(*events[count], strict=True))
        at = ropes[in_lanes], at_samples
        x = found.x[at] = by_rope(state.x)[in_lanes]
        found.v[at] = by_rope(state.v)[in_lanes]
        found.dissipated[at] = state.dissipated.reshape(-1, WIDTH).sum(axis=0)[in_lanes]
        # The kernels look at a position when they evaluate its forces, which at the last one they have not yet done.
        found.low[at] = np.minimum(by_rope(state.low)[in_lanes], x).min(axis=(2, 3))
        found.high[at] = np.maximum(by_rope(state.high)[in_lanes], x).max(axis=(2, 3))
