"""Starts of a nonlinear sea: from a linear one, or from elevation and surface potential."""

import math
from typing import Any

import numpy as np

from sim.ocean.medium import Medium
from sim.ocean.nonlinear.modes import Modes, make_modes, spectrum_of
from sim.ocean.sea import LENGTHS, SIZES, Sea
from sim.ocean.spectra import Conditions
from sim.validation import argument_error, as_array, check_number, is_whole_number

ALLOWED = "a Sea, or elevation and potential, two finite arrays (n, m) or (n,) of one shape"


def started(start: Any, size: Any, length: Any, water: dict[str, Any]) -> tuple[Modes, np.ndarray, Conditions]:
    """Waves, spectra (2, rows, columns) of elevation and potential, and conditions of a start.

    Arguments as of `NonlinearSea`; water: depth, gravity and density, or None for each. Raises ValueError for a value
    that is not allowed or not that of the start.
    """
    given = {name: value for name, value in water.items() if value is not None}
    if isinstance(start, Sea):
        conditions = start.conditions
        if start.medium != Medium() or conditions.tension != 0.0:
            raise argument_error("start", start, "a sea without tension, viscosity, film or a dispersion of its own")
        given["length"] = start.length if length is None else length
        for name, value in given.items():
            own = start.length if name == "length" else getattr(conditions, name)
            if value not in (own, (own, own)):
                raise argument_error(name, value, f"that of the sea it starts from, {own:g}")
        cells = checked_size(start.size if size is None else size)
        modes = make_modes(cells, (start.length, start.length), conditions.depth, conditions.gravity)
        return modes, linear_start(start, modes), conditions
    if not isinstance(start, tuple | list) or len(start) != 2:
        raise argument_error("start", start, ALLOWED)
    fields = [as_array("start", field, ALLOWED) for field in start]
    if fields[0].ndim not in (1, 2) or fields[0].shape != fields[1].shape or not np.isfinite(fields).all():
        raise argument_error("start", [field.shape for field in fields], ALLOWED)
    n, m = checked_size((len(fields[0]), fields[0].size // max(len(fields[0]), 1)))
    if size is not None and checked_size(size) != (n, m):
        raise argument_error("size", size, f"that of the arrays, {(n, m)}")
    conditions = Conditions(**({"density": 1025.0} | given))
    u = np.array([spectrum_of(field.reshape(n, m)) for field in fields])
    u[1, 0, 0] = 0.0  # a constant of the potential moves nothing
    return make_modes((n, m), sides_of(length), conditions.depth, conditions.gravity), u, conditions


def checked_size(size: Any) -> tuple[int, int]:
    """`size` as cells along x and y. Raises ValueError otherwise."""
    low, high = SIZES
    cells = (size, size) if is_whole_number(size) else size
    n, m = cells if isinstance(cells, tuple) and len(cells) == 2 else (0, 0)
    if not all(is_whole_number(c) and c <= high for c in (n, m)) or n < low or n % 2 or (m != 1 and (m < 4 or m % 2)):
        allowed = f"even whole numbers (n, m), n from {low} and m from 4 to {high} or m = 1, or one number for both"
        raise argument_error("size", size, allowed)
    return int(n), int(m)


def sides_of(length: Any) -> tuple[float, float]:
    """One length or two as two [m]. Raises ValueError otherwise."""
    x, y = length if isinstance(length, tuple | list) and len(length) == 2 else (length, length)
    return check_number("length", x, *LENGTHS, "m"), check_number("length", y, *LENGTHS, "m")


def linear_start(sea: Sea, modes: Modes) -> np.ndarray:
    """Spectra (2, rows, columns) of elevation and potential at z = 0 of a linear sea at its time, without its rings.

    Waves that only one of the two grids has are left out.
    """
    waves = sea.components(sea.time)
    n, m = modes.size
    i, j = (np.rint(k * (sea.length / (2.0 * math.pi))).astype(int) for k in (waves.kx, waves.ky))
    # a cos(k.x - omega t + 2 pi phase), and its potential (g/omega) a sin(...)
    wave = 0.5 * waves.amplitude * np.exp(1j * (2.0 * math.pi * waves.phase - waves.omega * sea.time))
    spectra = wave, -1j * modes.gravity / waves.omega * wave
    u = np.zeros((2, m, n // 2), complex)
    there = (np.abs(i) < n // 2) & (np.abs(j) < max(m // 2, 1))
    for field, values in zip(u, spectra, strict=True):
        # A real field has the conjugate at -k; the half plane has kx >= 0.
        for column, row, value in ((i, j, values), (-i, -j, values.conj())):
            inside = there & (column >= 0)
            np.add.at(field, (row[inside], column[inside]), value[inside])
    return u


def mean_wavenumber(modes: Modes, eta: np.ndarray) -> float:
    """Mean wavenumber [rad/m] by energy; the smallest of the tile for still water."""
    weight = (np.abs(eta) ** 2 * modes.weight) * (modes.k > 0.0)
    smallest = 2.0 * math.pi / max(modes.length)
    return max(float((weight * modes.k).sum() / weight.sum()), smallest) if weight.sum() > 0.0 else smallest
