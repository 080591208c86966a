"""Starts of a nonlinear sea: from a linear one, or from elevation and surface potential."""

import dataclasses
import math
from typing import Any, NamedTuple

import numpy as np

from sim.numerics.angles import within_half_turn
from sim.ocean.fluids.medium import Medium
from sim.ocean.nonlinear.modes import Modes, make_modes, spectrum_of
from sim.ocean.spectra import Conditions
from sim.ocean.tile.sea import LENGTHS, SIZES, Sea
from sim.validation import argument_error, as_array, check_number, is_whole_number
from sim.waves import Waves

ALLOWED = "a Sea, Waves, or elevation and potential, two finite arrays (n, m) or (n,) of one shape"


class Start(NamedTuple):
    """The start of a nonlinear sea."""

    modes: Modes
    u: np.ndarray  # (2, rows, columns) spectra of elevation [m] and potential [m2/s] at z = 0
    conditions: Conditions
    time: float  # [s]
    is_linear: bool  # the start has no bound waves


def started(start: Any, size: Any, length: Any, water: dict[str, Any], time: float) -> Start:
    """The start of a `NonlinearSea`, from its arguments; water: depth, gravity and density, or None for each.

    Raises ValueError for a value that is not allowed or not that of the start.
    """
    properties = {name: value for name, value in water.items() if value is not None}
    if isinstance(start, Sea):
        if start.medium != Medium() or start.conditions.tension != 0.0:
            raise argument_error("start", start, "a sea without tension, viscosity, film or a dispersion of its own")
        time = start.time
        own = {"length": start.length, **dataclasses.asdict(start.conditions.water)}
        length, size = start.length if length is None else length, start.size if size is None else size
        waves = start.waves_at(time)
    elif isinstance(start, Waves):
        waves, own = start, dataclasses.asdict(start.water)
    else:
        return of_fields(start, size, length, properties, time)
    for name, value in {**properties, "length": length}.items():
        if name in own and value not in (own[name], (own[name],) * 2):
            raise argument_error(name, value, f"that of the waves it starts from, {own[name]:g}")
    own.pop("length", None)
    conditions = Conditions(**(properties | own))
    modes = make_modes(checked_size(size), sides_of(length), conditions.water)
    return Start(modes, linear_start(waves, modes, time), conditions, time, True)


def of_fields(start: Any, size: Any, length: Any, water: dict[str, Any], time: float) -> Start:
    """The same of a start by elevation [m] and potential [m2/s]."""
    if not isinstance(start, tuple | list) or len(start) != 2:
        raise argument_error("start", start, ALLOWED)
    fields = [as_array("start", field, ALLOWED) for field in start]
    if fields[0].ndim not in (1, 2) or fields[0].shape != fields[1].shape or not np.isfinite(fields).all():
        raise argument_error("start", [field.shape for field in fields], ALLOWED)
    n, m = checked_size((len(fields[0]), fields[0].size // max(len(fields[0]), 1)))
    if size is not None and checked_size(size) != (n, m):
        raise argument_error("size", size, f"that of the arrays, {(n, m)}")
    conditions = Conditions(**water)
    u = np.array([spectrum_of(field.reshape(n, m)) for field in fields])
    u[1, 0, 0] = 0.0  # a constant of the potential moves nothing
    return Start(make_modes((n, m), sides_of(length), conditions.water), u, conditions, time, False)


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
    return check_number("length", x, "m", *LENGTHS), check_number("length", y, "m", *LENGTHS)


def linear_start(waves: Waves, modes: Modes, t: float) -> np.ndarray:
    """Spectra (2, rows, columns) of elevation and potential at z = 0 of linear waves at time t [s].

    Waves outside the grid are left out; others are moved to its nearest.
    """
    n, m = modes.size
    i, j = (np.rint(k * (side / (2.0 * math.pi))).astype(int)
            for k, side in zip((waves.kx, waves.ky), modes.length, strict=True))  # fmt: skip
    # a cos(k.x - omega t + phase), and its potential (g/omega) a sin(...)
    wave = 0.5 * waves.amplitude * np.exp(1j * (waves.phase - waves.omega * t))
    spectra = wave, -1j * modes.water.gravity / np.where(waves.omega > 0.0, waves.omega, math.inf) * wave
    u = np.zeros((2, m, n // 2), complex)
    there = (np.abs(i) < n // 2) & (np.abs(j) < max(m // 2, 1))
    for field, values in zip(u, spectra, strict=True):
        # A real field has the conjugate at -k; the half plane has kx >= 0.
        for column, row, value in ((i, j, values), (-i, -j, values.conj())):
            inside = there & (column >= 0)
            np.add.at(field, (row[inside], column[inside]), value[inside])
    return u


def free_waves(modes: Modes, u: np.ndarray, t: float) -> Waves:
    """The linear waves that have these spectra (2, rows, columns) of elevation and potential at time t [s].

    A wave of the half plane and its complex conjugate, at -k, are one. So are the two halves of the column kx = 0.
    """
    KX, KY = np.broadcast_arrays(modes.kx, modes.ky[:, None])
    there = ((KX > 0.0) | (KY > 0.0)) & u.any(axis=0)
    kx, ky, omega = KX[there], KY[there], modes.omega[there]
    turned = 1j * omega / modes.water.gravity * u[1][there]
    onward, back = u[0][there] + turned, np.conj(u[0][there] - turned)
    waves, frequency = np.concatenate([onward, back]), np.tile(omega, 2)
    phase = np.angle(waves) + frequency * t
    kx, ky = np.concatenate([kx, -kx]), np.concatenate([ky, -ky])
    return Waves(kx, ky, np.abs(waves), within_half_turn(phase), frequency, modes.water)


def resized(modes: Modes, u: np.ndarray, size: tuple[int, int]) -> tuple[Modes, np.ndarray]:
    """Modes of a grid of another size on the same rectangle, and the spectra (2, rows, columns) on it."""
    new = make_modes(size, modes.length, modes.water)
    columns, rows = min(size[0], modes.size[0]) // 2, max(min(size[1], modes.size[1]) // 2, 1)
    out, row = np.zeros((2, len(new.ky), len(new.kx)), complex), np.arange(1 - rows, rows)
    out[:, row, :columns] = u[:, row, :columns]
    return new, out


def mean_wavenumber(modes: Modes, eta: np.ndarray) -> float:
    """Mean wavenumber [rad/m] by energy; the smallest of the tile for still water."""
    weight = (np.abs(eta) ** 2 * modes.weight) * (modes.k > 0.0)
    smallest = 2.0 * math.pi / max(modes.length)
    return max(float((weight * modes.k).sum() / weight.sum()), smallest) if weight.sum() > 0.0 else smallest
