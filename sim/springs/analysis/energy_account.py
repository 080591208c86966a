"""The energy account of a run: stored, dissipated and supplied energy, and numerical error.

stored + dissipated - work - initial is 0 in the exact motion. The kernels add to `dissipated` and `work` of `State`
(`add_power`). Where the parameters of a running net change, its stored energy jumps. The change has done that work, as
if a hand had replaced a loaded spring, so the jump is added to `work`, and the error is the same before and after it.
"""

from sim.springs.net import Net
from sim.springs.state import State, energy


class EnergyAccount:
    """The account of one run from `state` on, which must be advanced `with_account`; sets its two sums to 0."""

    def __init__(self, net: Net, state: State) -> None:
        state.dissipated = state.work = 0.0
        self.initial = energy(net, state)
        self.start_method(net, state)

    def stored(self, net: Net, state: State) -> float:
        """Stored energy [J]."""
        return energy(net, state).total

    def error(self, net: Net, state: State) -> float:
        """Energy [J] that is stored or dissipated without having been put in: numerical error."""
        return self.stored(net, state) + state.dissipated - state.work - self.initial.total

    def book_change(self, stored: float, net: Net, state: State) -> None:
        """Count a change of parameters as work. stored: energy [J] before it; `net` and `state`: as they are now."""
        state.work += self.stored(net, state) - stored

    def start_method(self, net: Net, state: State) -> None:
        """Another integrator takes over: its losses are counted from here on."""
        self.error_before_method = self.error(net, state)
        self.dissipated_before_method = state.dissipated

    def numerical_dissipation(self, net: Net, state: State) -> float:
        """Energy [J] dissipated by the method of integration since `start_method`; negative if it added energy."""
        return self.error_before_method - self.error(net, state)

    def damping_dissipation(self, state: State) -> float:
        """Energy [J] dissipated by damping since `start_method`."""
        return state.dissipated - self.dissipated_before_method
