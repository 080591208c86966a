"""A spill over hours, stepped plainly, with the pseudo-components that NOAA's adios_db 1.2.7 makes of the records.

Written from the laws as PyGNOME applies them (July 2026): within a short step everything is constant, and one process
follows the other. Slow and of first order, so that nothing of `sim.ocean.weathering` is repeated here.
"""

import math
from typing import NamedTuple

import numpy as np


class Record(NamedTuple):
    """An oil as PyGNOME takes it."""

    density: float  # [kg/m3] at 15 C
    viscosity: float  # [m2/s] at 15 C
    onset: float
    most_water: float
    # share by mass, boiling point [K], molar mass [g/mol], density [kg/m3]
    parts: tuple[tuple[float, float, float, float], ...]


OILS = {
    "Alaska North Slope 2002": Record(
        866.3,
        1.3852e-05,
        0.305,
        0.73,
        (
            (0.022795, 288, 63.6946, 669.433),
            (0.0414711, 331.5, 81.4645, 701.57),
            (0.000538925, 331.5, 70.5847, 841.884),
            (0.185817, 418, 124.856, 757.94),
            (0.0159561, 418, 111.033, 909.528),
            (0.104204, 523, 195.668, 816.727),
            (0.0197746, 523, 178.565, 980.072),
            (0.115299, 606.5, 271.536, 858.064),
            (0.0331775, 606.5, 252.861, 1029.68),
            (0.152423, 725, 425.822, 910.659),
            (0.0698368, 725, 410.505, 1090),
            (0.0840707, 875, 782.876, 969.569),
            (0.0111832, 875, 820.513, 1090),
            (0.0434521, 1000, 1583.18, 1013.7),
            (0.06, 1000, 800, 1100),
            (0.04, 1000, 1000, 1100),
        ),
    ),
    "Arabian Light": Record(
        864.1,
        1.5045e-05,
        0,
        0.91,
        (
            (0.0102651, 288, 63.6946, 669.433),
            (0.00670489, 331.5, 81.4645, 701.57),
            (0.179143, 418, 124.856, 757.94),
            (0.010056, 418, 111.033, 909.528),
            (0.111721, 523, 195.668, 816.727),
            (0.016261, 523, 178.565, 980.072),
            (0.117402, 606.5, 271.536, 858.064),
            (0.0267964, 606.5, 252.861, 1029.68),
            (0.152242, 725, 425.822, 910.659),
            (0.0560917, 725, 410.505, 1090),
            (0.0978023, 875, 782.876, 969.569),
            (0.0352405, 875, 820.513, 1090),
            (0.0842742, 1000, 1583.18, 1013.7),
            (0.06, 1000, 800, 1100),
            (0.036, 1000, 1000, 1100),
        ),
    ),
    "diesel 2002": Record(
        831.0,
        3.6101e-06,
        1,
        0,
        (
            (0.00490354, 331.5, 81.4645, 701.57),
            (7.39607e-05, 331.5, 70.5847, 841.884),
            (0.570873, 418, 124.856, 757.94),
            (0.0507489, 418, 111.033, 909.528),
            (0.261598, 523, 195.668, 816.727),
            (0.0491771, 523, 178.565, 980.072),
            (0.0317194, 606.5, 271.536, 858.064),
            (0.00235951, 725, 425.822, 910.659),
            (0.00483352, 875, 782.876, 969.569),
            (0.00371306, 1000, 1583.18, 1013.7),
            (0.02, 1000, 800, 1100),
        ),
    ),
}


def spill(name: str, volume: float, wind: float, hours: float, step: float = 20.0) -> dict[str, float]:
    """Fractions evaporated, dispersed and of water, area [m2] and kinematic viscosity [m2/s] some hours later, at 15 C
    on water of 1025 kg/m3. step [s]; wind [m/s], above 4.43."""
    oil = OILS[name]
    share, boiling, molar, _ = (np.array(column) for column in zip(*oil.parts, strict=True))
    molar = molar / 1000.0
    T, R, g, nu_water, rho_water = 288.15, 8.314, 9.80665, 1e-6, 1025.0
    start = volume * oil.density
    mass = start * share
    c = 0.19 * boiling - 18.0
    entropy = 8.75 + 1.987 * np.log(boiling)
    exponent = entropy * (boiling - c) ** 2 / (0.97 * 1.987 * boiling) * (1.0 / (boiling - c) - 1.0 / (T - c))
    pressure = 101325.0 * np.exp(exponent)
    buoyancy = (rho_water - oil.density) / rho_water
    area = math.pi * 1.21**4 / 1.53**2 * (volume**5 * g * buoyancy / nu_water**2) ** (1 / 6)
    begins = (1.21 / 1.53) ** 4 * (volume / (nu_water * g * buoyancy)) ** (1 / 3)
    fay = math.pi * 1.45**2 * (volume**2 * g * buoyancy / math.sqrt(nu_water)) ** (1 / 3)
    eddies = 8.0 * math.pi * 0.033
    thinnest = 1e-5 if oil.viscosity < 1e-6 else min(1e-5 + 0.9091 * (oil.viscosity - 1e-6), 1e-4)
    rms = 0.707 * 0.243 * wind**2 / g
    whitecaps = 0.5 * (0.01 * wind + 0.01) / (0.03742857 * 35.0 + 2.54)
    energy = 0.0034 * rho_water * g * rms**2
    evaporated = dispersed = drops = water = 0.0
    began = None
    thick = oil.viscosity
    for n in range(round(hours * 3600.0 / step)):
        if mass.sum() <= 1e-4 * start:
            break
        across = max(2.0 * math.sqrt(area / math.pi), 1.0)
        transfer = 0.0048 * wind**0.78 * across ** (-1 / 9) * 1.380277 * (0.018 / molar) ** (1 / 3)
        decay = (1.0 - water) * area * transfer * pressure / (R * T * (mass / molar).sum())
        left = mass * np.exp(-decay * step)
        evaporated += (mass - left).sum()
        mass = left
        roy = 2400.0 * math.exp(-73.682 * math.sqrt(thick))
        lost = min(roy * energy**0.57 * whitecaps * 3.9e-8 * (1.0 - water) * area * step, mass.sum())
        dispersed += lost
        mass = mass * (1.0 - lost / mass.sum())
        now = (n + 1) * step
        if oil.most_water > 0.0 and evaporated / start >= oil.onset:
            began = now if began is None else began
            rate = 6.0 * 2.02e-6 * wind**2 / 1e-5
            finest = 6.0 / 1e-6 * oil.most_water / (1.0 - oil.most_water)
            drops = min(drops + rate * step * math.exp(-rate / finest * (now - began)), finest)
            water = min(drops * 1e-5 / (6.0 + drops * 1e-5), oil.most_water)
        if now > begins:
            area += step * (0.5 * fay**2 / area + 7.0 / 6.0 * eddies * (area / eddies) ** (1 / 7))
            area = min(area, volume / thinnest)
        x = water / 0.84
        factor = min(max(1500.0 * math.sqrt(oil.viscosity), 1.0), 10.0)
        thick = oil.viscosity * math.exp(factor * evaporated / start) * (1.0 + x / (1.187 - x)) ** 2.49
    return {
        "evaporated": evaporated / start,
        "dispersed": dispersed / start,
        "water_content": water,
        "area": area,
        "viscosity": thick,
    }
