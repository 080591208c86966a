"""The common part of rope and cloth: the scene of one spring network, its checkpoints, divergence and plot rows."""

import abc
from typing import Any, ClassVar, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from app.messages import PlotRow
from app.scenes.charts import Columns
from app.scenes.checkpoints import copied, restore
from app.scenes.contract import MethodParams
from app.scenes.plot_rows import PlotRows
from app.scenes.springs.divergence import MAX_OVERSHOOT, LastMoments, divergence_text
from app.scenes.springs.grab import ParticleGrab
from app.scenes.springs.net_motion import Bound, NetMotion
from app.scenes.springs.recent_gauges import RecentGauges
from sim.springs import Net
from sim.springs.analysis.extremes import Extremes, extremes
from sim.springs.automatic import AUTO
from sim.springs.integrator_fallback import integrator_or_fallback
from sim.springs.state import State, energy, velocities
from sim.validation import DivergenceError

P = TypeVar("P", bound=MethodParams)


class NetScene(abc.ABC, Generic[P]):
    """A spring network on the simulation thread."""

    pace = 1.0
    CHANGING: ClassVar[tuple[str, ...]]  # attributes that change as the net moves
    ASSESSMENT_INTERVAL: ClassVar[float]  # [s] of simulated time between two assessments of the stability

    grab: ParticleGrab
    motion: NetMotion
    stability: Any  # readings: the worst of the last assessments
    fallback_note: str
    assessed_at: float  # [s]

    def __init__(self, params: P) -> None:
        self.params = params
        self.plot_rows = PlotRows()
        self.last_moments = LastMoments()
        self.recent: RecentGauges[Any] = RecentGauges()
        self.reset()

    @property
    def step(self) -> float:
        """Time step [s]."""
        return self.params.time_step

    @property
    def net(self) -> Net:
        """The present net."""
        return self.motion.net

    @property
    def state(self) -> State:
        """The last good state."""
        return self.motion.state

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.state.t

    @property
    def note(self) -> str:
        """Reason why the method differs from the chosen one, or ""."""
        return "" if self.params.integrator == AUTO else self.fallback_note

    @property
    def with_account(self) -> bool:
        """True if the energy account is kept."""
        return True

    @abc.abstractmethod
    def reset(self) -> None:
        """Restart with `params`."""

    @abc.abstractmethod
    def net_during(self, t: float, duration: float) -> Net:
        """The net with the motions caused by a user over the next `duration` [s] from time t [s]."""

    @abc.abstractmethod
    def moved(self, good: State, steps: int, extremes: Extremes) -> None:
        """React to steps from the state `good` to one with these extremes."""

    @abc.abstractmethod
    def assess_stability(self) -> None:
        """Compare the step with its limit at the present state."""

    @abc.abstractmethod
    def has_news(self) -> bool:
        """True if the stability may have changed since the last assessment, and it is known quickly."""

    @abc.abstractmethod
    def alternative(self) -> str:
        """Another stable setting after a divergence; "" without one."""

    @abc.abstractmethod
    def add_plot_row(self) -> None:
        """Add a plot row at the scene's time."""

    @abc.abstractmethod
    def frame(self) -> object:
        """Frame to draw; kept for a while, to be shown again if the run diverges."""

    @abc.abstractmethod
    def laid_out(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Positions or velocities (3, rows, cols) with the axis last, in an array of their own."""

    def place_at_rest(self, net: Net, bound: Bound) -> None:
        """Begin a run of this net."""
        method, self.fallback_note = integrator_or_fallback(self.params.integrator, net, self.step)
        self.motion = NetMotion(net, method, self.step, bound)
        self.plot_rows.restart()
        self.last_moments.clear()
        self.recent.clear()

    def keep(self) -> dict[str, object]:
        """Checkpoint: state, energy account and moved objects."""
        return copied({name: getattr(self, name) for name in self.CHANGING})

    def resume(self, checkpoint: object) -> None:
        """Resume from a checkpoint of `keep`."""
        restore(self, checkpoint)
        self.choose_method()
        self.grab.clear()
        self.plot_rows.resume()
        self.last_moments.clear()
        self.recent.clear()

    def take_net(self, net: Net, *, still_pins: bool = False) -> None:
        """Continue with another net, as `NetMotion.change_net` does."""
        self.recent.clear()
        if net.shape != self.net.shape:
            self.grab.clear()
        self.motion.change_net(net, still_pins=still_pins)
        self.choose_method()

    def choose_method(self) -> None:
        """Continue with the method and step of the parameters, or another method if the net does not allow it."""
        method, self.fallback_note = integrator_or_fallback(self.params.integrator, self.net, self.step)
        self.motion.use(method, self.step)

    def advance(self, steps: int) -> None:
        """Take steps. Raises DivergenceError if the net leaves its bounds, and keeps the last good state."""
        self.add_due_row()  # of the start
        motion, good = self.motion, self.state  # which is shown in the middle of the steps
        state = good.copy()
        net = self.net_during(good.t, steps * self.step)
        try:
            net = self.take_steps(net, state, steps)
        finally:  # the steps before a cancellation count
            state_extremes = extremes(state.x, state.v)
            if motion.holds(state_extremes):
                motion.state = state
        if motion.state is good:
            self.repeat_to_divergence(net, good, steps)
            raise DivergenceError(self.diagnosis(), tuple(self.last_moments))
        motion.net = net
        self.moved(good, steps, state_extremes)
        if self.state.t - self.assessed_at >= self.ASSESSMENT_INTERVAL and self.has_news():
            self.assess_stability()
        self.add_due_row()

    def add_due_row(self) -> None:
        """Add the plot row of now, if one is due."""
        if self.plot_rows.is_due(self.state.t):
            self.add_plot_row()

    def take_steps(self, net: Net, state: State, steps: int) -> Net:
        """Take steps of `net` in place. Returns the net that took the last one."""
        self.motion.take_steps(net, state, steps, with_account=self.with_account)
        return net

    def repeat_to_divergence(self, net: Net, good: State, steps: int) -> None:
        """Repeat the steps that left the bounds, keep a frame of each, and return to the last good state."""
        motion = self.motion
        motion.state = good.copy()
        try:
            for _ in range(steps):
                motion.take_steps(net, self.state, 1, with_account=self.with_account)
                state_extremes = extremes(self.state.x, self.state.v)
                if state_extremes.reach < MAX_OVERSHOOT * motion.max_reach:  # false for NaN too
                    self.frame()
                if not motion.holds(state_extremes):
                    break
        finally:  # it may be cancelled
            motion.state = good

    def diagnosis(self) -> str:
        """Cause of the divergence, and settings that would be stable."""
        return divergence_text(self.time, self.motion.method, self.step, self.stability.stability, self.alternative())

    def take_plot_rows(self) -> tuple[PlotRow, ...]:
        """The plot rows since the last call."""
        return self.plot_rows.take()

    def curves(self) -> dict[str, Columns] | None:
        """The charts that are not over time; None without one."""
        return None

    def arrays(self) -> dict[str, tuple[NDArray[np.float64], str]]:
        """The state for a file: name -> (array, unit)."""
        return {
            "x": (self.laid_out(self.state.x), "m"),
            "v": (self.laid_out(velocities(self.net, self.state)), "m/s"),
            "energy": (np.array([*energy(self.net, self.state)]), "J: kinetic, elastic, gravity, contact"),
        }
