"""The last change of a sea's conditions, to which its waves adapt."""

from typing import NamedTuple

from app.scenes.square_sea.foam_limit import cover_in

SETTLING_TRANSITIONS = 16.0  # transition times after which nothing is left of the old weather (e^-16 = 1e-7)


class WeatherChange(NamedTuple):
    """The time of the change, and the sea before it."""

    at: float  # [s]
    transition: float  # [s] in which the waves adapt
    foam_cover: float  # fraction of the sea that was foam then, if no wave was damped
    viscous_area: float  # [m2] sum of viscosity times time, from the start to then

    def is_under_way(self, t: float) -> bool:
        """True if waves of the old weather are left at time t [s]."""
        return t - self.at < SETTLING_TRANSITIONS * self.transition

    def foam_cover_at(self, t: float, wind_speed: float) -> float:
        """Fraction of the sea that is foam at time t [s] by Monahan's law, if no wave is damped; it adapts as waves do.

        wind_speed: [m/s] since the change.
        """
        return cover_in(wind_speed, self.foam_cover, t - self.at, self.transition)

    def viscous_area_at(self, t: float, viscosity: float) -> float:
        """The sum [m2] to time t [s]. viscosity: [m2/s] since the change."""
        return self.viscous_area + viscosity * (t - self.at)
