"""Gravity from mass: the lab's planets of 1/100, 1 and 100 Earth masses need a rule for the radius."""

from typing import NamedTuple

from sim.validation import check_choice, check_number
from sim.water import EARTH_GRAVITY

G = 6.67430e-11  # [m3/(kg s2)] CODATA 2018
MAX_MASS = 1e9  # [Earth masses] hundreds of suns: no planet

# R ~ M^exponent. Rocky: the mass-radius relation of rocky planets, exponent 0.27 (Valencia, O'Connell, Sasselov 2006).
RADIUS_RULES = {"same_radius": 0.0, "same_density": 1.0 / 3.0, "rocky": 0.27}


class Planet(NamedTuple):
    """A body of the Solar System."""

    mass: float  # [kg]
    radius: float  # [m], mean

    @property
    def gravity(self) -> float:
        """g = G M/R^2 [m/s2], without rotation."""
        return G * self.mass / self.radius**2


# NASA planetary and satellite fact sheets: mass, volumetric mean radius (gas giants: the 1 bar level).
SOLAR_SYSTEM = {
    "Mercury": Planet(3.3010e23, 2439.7e3),
    "Venus": Planet(4.8673e24, 6051.8e3),
    "Earth": Planet(5.9722e24, 6371.0e3),
    "Moon": Planet(7.346e22, 1737.4e3),
    "Mars": Planet(6.4169e23, 3389.5e3),
    "Jupiter": Planet(1.89813e27, 69911.0e3),
    "Saturn": Planet(5.6832e26, 58232.0e3),
    "Uranus": Planet(8.6811e25, 25362.0e3),
    "Neptune": Planet(1.02409e26, 24622.0e3),
    "Pluto": Planet(1.303e22, 1188.0e3),
    "Europa": Planet(4.7998e22, 1560.8e3),
    "Titan": Planet(1.34553e23, 2574.7e3),
    "Enceladus": Planet(1.0802e20, 252.1e3),
}


def gravity_of(mass: float, rule: str = "same_radius") -> float:
    """Surface gravity [m/s2] of a planet of `mass` Earth masses, above 0: g = G M/R^2, so g ~ M^(1 - 2 exponent).

    rule: one of RADIUS_RULES. Raises ValueError for another rule or a mass not above 0, or above MAX_MASS.

    >>> round(gravity_of(0.1), 2)  # [m/s2], a tenth of the Earth on its radius
    0.98
    """
    check_number("mass", mass, "Earth masses", 0.0, MAX_MASS, above=True)
    check_choice("rule", rule, RADIUS_RULES)
    return EARTH_GRAVITY * mass ** (1.0 - 2.0 * RADIUS_RULES[rule])
