"""The fading in of the nonlinear terms, for starts without bound waves (Dommermuth 2000, Wave Motion 32:307)."""

import dataclasses
import functools
import math

POWER = 4  # of time
WHOLE = 40.0 ** (1.0 / POWER)  # durations until the nonlinear part is whole to rounding


@dataclasses.dataclass(frozen=True)
class FadeIn:
    """Nonlinear terms grow as 1 - exp(-((t - start)/duration)^4)."""

    start: float  # [s]
    duration: float  # [s], or 0: they act at once

    @functools.cached_property
    def end(self) -> float:
        """Time [s] from which they are whole."""
        return self.start + WHOLE * self.duration

    def factor(self, t: float) -> float:
        """Factor on the nonlinear terms at time t [s]."""
        return 1.0 if t >= self.end else -math.expm1(-(((t - self.start) / self.duration) ** POWER))
