"""Compression of the water above which it is foam, chosen so that foam covers the expected part of the sea."""

import math

from app.scenes.square_sea.parameters import SquareSeaParams
from sim.ocean.statistics.foam import threshold, whitecaps

FULL_FOAM_DEPTH = 0.35  # the Jacobian of full foam lies this many standard deviations of the Jacobian below the limit
FOAM_CORRECTION_RATE = 0.15  # [1/s] standard deviations by which the limit moves where e times too little is drawn
INITIAL_FOAM_CORRECTION = 0.5  # standard deviations that the limit starts above the formula's
MIN_FOAM_COVER = 1e-4  # fraction of the sea below which differences of foam do not count
FOAM_VISIBLE_SHARE = 1.2  # multiple of the fading time for which a patch of foam counts as foam


def cover_in(wind_speed: float, before: float, since: float, transition: float) -> float:
    """Fraction of the sea that is foam in a wind [m/s] by Monahan's law, `since` [s] after it was `before`.

    It adapts as the waves do, within `transition` [s].
    """
    cover = whitecaps(wind_speed)
    return cover if transition == 0.0 else cover + (before - cover) * math.exp(-since / transition)


class FoamLimit:
    """The Jacobian below which there is foam."""

    def __init__(self) -> None:
        self.value = -math.inf
        self.correction = INITIAL_FOAM_CORRECTION  # standard deviations of the Jacobian above the formula's
        self.deviation = 0.0  # standard deviation of the Jacobian as drawn; 0: not drawn yet

    def update(
        self, p: SquareSeaParams, dt: float, slope: float, frequency: float, expected: float, drawn: float
    ) -> float:
        """Update the limit over dt [s]. Returns the Jacobian's distance below it at which foam is full.

        slope: mean square slope of the waves, which changes at `frequency` [rad/s]; expected and drawn: fractions of
        the sea that are foam.
        """
        deviation = self.deviation or max(p.choppiness * p.amplitude * math.sqrt(slope), 1e-6)
        self.value = p.foam_threshold
        if not p.foam:
            self.value = -math.inf
        elif p.foam_by_wind:
            # The formula holds for small slopes. The drawn foam tells what it misses, and corrects it slowly.
            missing = math.log((expected + MIN_FOAM_COVER) / (drawn + MIN_FOAM_COVER))
            correction = self.correction + FOAM_CORRECTION_RATE * dt * min(max(missing, -1.0), 1.0)
            self.correction = min(max(correction, -1.0), 2.0)
            limit = threshold(expected, deviation, frequency, FOAM_VISIBLE_SHARE * p.foam_fade)
            self.value = limit + self.correction * deviation
        return FULL_FOAM_DEPTH * deviation
