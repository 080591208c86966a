"""The laws of weathering, each on its own. Times [s], temperatures [K] unless a name says otherwise.

Those that `spill.py` uses have the constants of NOAA's PyGNOME (github.com/NOAA-ORR-ERD/PyGnome, in
py_gnome/gnome/weatherers, 2026). `fingas` and `stiver_mackay` are older laws of evaporation, kept for comparison.
"""

import math

import numpy as np
from numpy.typing import NDArray

from sim.ocean.fluids.emulsions import pal_rhodes_factor
from sim.ocean.weathering.components import CELSIUS, PseudoComponents
from sim.validation import check_number, check_positive

GAS_CONSTANT = 8.314  # [J/(mol K)]
ATMOSPHERE = 101325.0  # [Pa]
GRAVITY = 9.80665  # [m/s2]
WATER_VISCOSITY = 1e-6  # [m2/s] kinematic, of sea water in these laws
MIN_WIND = 1.0  # [m/s] least wind speed of the evaporation
SCHMIDT = 1.380277  # (Schmidt number of water vapour)^(-2/3)
WATER_MOLAR_MASS = 0.018  # [kg/mol]
UPTAKE = 2.02e-6  # [s/m2] rate of the water uptake over the wind squared
LARGEST_DROP, SMALLEST_DROP = 1e-5, 1e-6  # [m] of water in oil
ENTRAINED = 3.9e-8  # [m3] oil in drops small enough to stay below, summed over their sizes
FAY_INERTIAL, FAY_INITIAL, FAY_VISCOUS = 1.53, 1.21, 1.45
DIFFUSION = 4.0 * math.pi * 2.0 * 0.033  # of the area by eddies
DRIFT = 0.03  # speed of a slick over that of the wind


def vapour_pressure(boiling_point: NDArray[np.float64], temperature: float) -> NDArray[np.float64]:
    """Vapour pressure [Pa] of substances of these boiling points [K]: Antoine's equation (Lyman and others 1990)."""
    R = 1.987  # [cal/(mol K)]
    entropy = 8.75 + R * np.log(boiling_point)
    c = 0.19 * boiling_point - 18.0
    inverse = 1.0 / (boiling_point - c) - 1.0 / (temperature - c)
    return ATMOSPHERE * np.exp(entropy * (boiling_point - c) ** 2 / (0.97 * R * boiling_point) * inverse)


def volatility(parts: PseudoComponents, temperature: float) -> NDArray[np.float64]:
    """Sc_i^(-2/3) P_i/(R T) (n,) [mol/m3]: the part of the evaporation rate that depends on the component only."""
    schmidt = SCHMIDT * (WATER_MOLAR_MASS / parts.molar_mass) ** (1.0 / 3.0)
    return schmidt * vapour_pressure(parts.boiling_point, temperature) / (GAS_CONSTANT * temperature)


def evaporation_speed(area: float, wind_speed: float) -> float:
    """A K [m3/s], K = 0.0048 U^0.78 X^(-1/9), X the diameter of the slick, at least 1 m; U at least 1 m/s."""
    diameter = max(2.0 * math.sqrt(area / math.pi), 1.0)
    return area * 0.0048 * max(wind_speed, MIN_WIND) ** 0.78 * diameter ** (-1.0 / 9.0)


def evaporation_rates(
    parts: PseudoComponents,
    volatile: NDArray[np.float64],
    mass: NDArray[np.float64],
    area: float,
    water_content: float,
    wind_speed: float,
) -> NDArray[np.float64]:
    """Rate [1/s] at which each part of the oil evaporates; mass (n,) [kg], area [m2], wind 10 m up [m/s].

    volatile (n,) [mol/m3]: their `volatility`, which stays as it is while the oil evaporates.

    (1 - Y) A K Sc_i^(-2/3) P_i/(R T sum m_j/M_j) (Mackay and Matsugu 1973, Can. J. Chem. Eng. 51:434; Jones 1997).
    """
    moles = float((mass / parts.molar_mass).sum())
    return (1.0 - water_content) * evaporation_speed(area, wind_speed) / moles * volatile


def water_content(elapsed: float, wind_speed: float, most: float) -> float:
    """Fraction of water in the emulsion, by volume, `elapsed` [s] after its onset; at most `most`.

    S = S_max (1 - e^(-k t/S_max)), k = 6 K U^2/d_max, is the surface of the drops per volume of oil, S_max that of the
    smallest ones; Y = S d_max/(6 + S d_max) (Eley, Hey and Symonds 1988, Oil Chem. Pollut. 4:253; rate of Mackay).
    """
    most = check_number("most", most, "", 0.0, 0.99)
    if elapsed <= 0.0 or most == 0.0:
        return 0.0
    rate = 6.0 * UPTAKE * wind_speed**2 / LARGEST_DROP
    largest = 6.0 / SMALLEST_DROP * most / (1.0 - most)
    surface = -largest * math.expm1(-rate * elapsed / largest)
    return min(surface * LARGEST_DROP / (6.0 + surface * LARGEST_DROP), most)


def viscosity_factor(viscosity: float, evaporated: float, water: float) -> float:
    """Ratio of the oil's viscosity to that of the fresh oil; viscosity: kinematic, of the fresh oil [m2/s].

    e^(c f), c = 1500 sqrt(nu), at least 1 and at most 10, times the factor of Pal and Rhodes for the water in it.
    """
    return math.exp(min(max(1500.0 * math.sqrt(viscosity), 1.0), 10.0) * evaporated) * pal_rhodes_factor(water)


def lightness(oil: float, water: float) -> float:
    """1 - rho_oil/rho_water, 0 where the oil does not float."""
    return max(1.0 - oil / water, 0.0)


def initial_area(volume: float, light: float) -> tuple[float, float]:
    """(area [m2], time [s]) at which viscosity takes over from inertia: where the spreading of `area_growth` begins.

    pi k2^4/k1^2 (V^5 g D/nu^2)^(1/6) and (k2/k1)^4 (V/(nu g D))^(1/3) (Fay 1971; Dodge and others 1983).
    """
    if light == 0.0:
        return math.inf, 0.0
    area = math.pi * FAY_INITIAL**4 / FAY_INERTIAL**2
    area *= (volume**5 * GRAVITY * light / WATER_VISCOSITY**2) ** (1.0 / 6.0)
    time = (FAY_INITIAL / FAY_INERTIAL) ** 4 * (volume / (WATER_VISCOSITY * GRAVITY * light)) ** (1.0 / 3.0)
    return area, time


def area_growth(area: float, volume: float, light: float) -> float:
    """Growth [m2/s] of a slick: Fay's gravity against viscosity, C^2/(2 A), and eddies, 7/6 K (A/K)^(1/7).

    C = pi k^2 (V^2 g D/sqrt(nu))^(1/3), k = 1.45, so that A = C sqrt(t) without eddies.
    """
    fay = math.pi * FAY_VISCOUS**2 * (volume**2 * GRAVITY * light / math.sqrt(WATER_VISCOSITY)) ** (1.0 / 3.0)
    return 0.5 * fay**2 / area + 7.0 / 6.0 * DIFFUSION * (area / DIFFUSION) ** (1.0 / 7.0)


def least_thickness(viscosity: float) -> float:
    """Thickness [m] at which a slick stops spreading, by the kinematic viscosity of the fresh oil [m2/s]."""
    return 1e-5 + 0.9091 * (min(max(viscosity, 1e-6), 1e-4) - 1e-6)


def wave_height(wind_speed: float) -> float:
    """Root mean square height [m] of a fully grown sea, as ADIOS2 has it; at most 30 m."""
    stress = 0.71 * wind_speed**1.23 if wind_speed < 4.433049525859078 else wind_speed
    return min(0.707 * 0.243 * stress**2 / GRAVITY, 30.0)


def breaking_share(wind_speed: float, salinity: float = 35.0) -> float:
    """Fraction of the sea that breaks per second, as PyGNOME has it (Ding and Farmer 1994; Monahan 1971)."""
    decay = 0.03742857 * salinity + 2.54
    return min(0.5 * (0.0125 * wind_speed if wind_speed < 4.0 else 0.01 * wind_speed + 0.01) / decay, 1.0)


def dispersion_rate(area: float, viscosity: float, water: float, wind_speed: float, water_density: float) -> float:
    """Oil [kg/s] that breaking waves take down in drops too small to rise; viscosity of the emulsion [m2/s].

    2400 e^(-73.682 sqrt(nu)) D^0.57 F V (1 - Y) A, D = 0.0034 rho g H^2 (Delvigne and Sweeney 1988, Oil and Chemical
    Pollution 4:281).
    """
    energy = 0.0034 * water_density * GRAVITY * wave_height(wind_speed) ** 2
    constant = 2400.0 * math.exp(-73.682 * math.sqrt(viscosity))
    return constant * energy**0.57 * breaking_share(wind_speed) * ENTRAINED * (1.0 - water) * area


def drift_speed(wind_speed: float) -> float:
    """Speed [m/s] at which a slick drifts downwind: 3 % of the wind's."""
    return DRIFT * check_number("wind_speed", wind_speed, "m/s", 0.0)


def fingas(distilled: float, temperature: float, minutes: float, *, is_crude: bool = True) -> float:
    """Fraction evaporated by Fingas's law (2004, J. Hazard. Mater. 107:27), independent of wind and thickness.

    distilled: fraction by mass that has boiled off at 180 C; temperature T [K]. With C = T - 273.15, in percent:
    (0.165 D + 0.045 (C - 15)) ln t and, for diesel and the like, (0.0254 D + 0.01 (C - 15)) sqrt t, t in minutes, up
    to five days.
    """
    percent = 100.0 * check_number("distilled", distilled, "", 0.0, 1.0)
    t = check_number("minutes", minutes, "min", 0.0)
    if t <= 1.0:
        return 0.0
    warm = check_positive("temperature", temperature, "K") - CELSIUS - 15.0
    if is_crude:
        lost = (0.165 * percent + 0.045 * warm) * math.log(t)
    else:
        lost = (0.0254 * percent + 0.01 * warm) * math.sqrt(t)
    return min(max(lost / 100.0, 0.0), 1.0)


def stiver_mackay(exposure: float, temperature: float, api: float, *, is_crude: bool = True) -> float:
    """Fraction by volume evaporated by Stiver and Mackay (1984, Environ. Sci. Technol. 18:834).

    T/(B G) ln(1 + B G/T theta e^(A - B T0/T)), A = 6.3, B = 10.3; exposure theta = K A t/V with K = 0.0025 U^0.78 m/s;
    T0 and G [K], start and slope of the distillation, by degrees API (ADIOS).
    """
    A, B = 6.3, 10.3
    theta = check_number("exposure", exposure, "", 0.0)
    t = check_positive("temperature", temperature, "K")
    start, slope = (
        (532.98 - 3.1295 * api, 985.62 - 13.597 * api) if is_crude else (654.45 - 4.6588 * api, 388.19 - 3.8725 * api)
    )
    lost = t / (B * slope) * math.log1p(B * slope / t * theta * math.exp(A - B * start / t))
    return min(lost, 1.0)
