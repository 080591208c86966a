"""Nonlinear waves: run time against error of order and grid, a step over its bare transforms, and plain numpy."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from app.scenes.timer import effort_clock
from benchmarks.peers.nonlinear import PlainSea
from benchmarks.peers.separable import separable_flow
from benchmarks.timing import processor_time
from sim.ocean import Sea
from sim.ocean.nonlinear import NonlinearSea, stokes_wave
from sim.ocean.nonlinear.padded_transforms import PaddedTransforms, Work, padded_size

LENGTH, STEEPNESS, PERIODS = 50.0, 0.2, 20  # [m], k a and periods of the steep wave
GRAVITY = 9.81
SEA_SIZE, SEA_ORDER, SEA_REPEATS = 128, 3, 40  # of the sea that is timed step by step
SEA_TOLERANCE, SEA_DURATION = 1e-4, 30.0  # as in the square sea; [s]
FLOW_SIZE, FLOW_POINTS, FLOW_REPEATS = 64, 200, 30  # of the water below a sea of order 3


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """The form and the phase of a wave of k a = 0.2 after 20 periods, over its height and its turn, and the time."""
    found = []
    for order, size in ((3, 16), (5, 24)) if quick else ((3, 16), (5, 16), (5, 24), (7, 24), (7, 32)):
        found += [ours(order, size, rtol) for rtol in ((1e-5,) if quick else (1e-3, 1e-5, 1e-7))]
        found += [plain(order, size, steps) for steps in ((40,) if quick else (20, 40, 80))]
    return found


def start(size: int) -> tuple[Any, np.ndarray, np.ndarray]:
    """The exact wave, and its elevation [m] and potential [m2/s] on a grid."""
    wave = stokes_wave(2.0 * STEEPNESS * LENGTH / (2.0 * math.pi), LENGTH, order=20)
    x = np.arange(size) * LENGTH / size
    return wave, wave.elevation(x), wave.potential(x)


def record(program: str, order: int, size: int, steps: float, seconds: float, height: np.ndarray) -> dict[str, Any]:
    """A row. height (size,) [m]: at the end."""
    wave, elevation, _ = start(size)
    h = np.fft.rfft(height)
    still = np.fft.irfft(h * np.exp(-1j * np.arange(len(h)) * np.angle(h[1])), size)
    return {
        "program": program, "order": order, "size": size, "steps a period": steps, "ms a period": seconds * 1e3,
        "form error": float(np.abs(still - elevation).max()) / wave.height,
        "phase error": float(abs(np.angle(h[1]))) / (2.0 * math.pi * PERIODS),
    }  # fmt: skip


def ours(order: int, size: int, rtol: float) -> dict[str, Any]:
    """Our run with a tolerance."""
    wave, elevation, potential = start(size)
    period = LENGTH / wave.speed

    def run() -> NonlinearSea:
        sea = NonlinearSea(length=LENGTH, order=order, start=(elevation, potential), breaking=False, rtol=rtol)
        sea.advance(PERIODS * period)
        return sea

    run()
    began = effort_clock()
    sea = run()
    seconds = (effort_clock() - began) / PERIODS
    return record("springtide", order, size, sea.steps / PERIODS, seconds, sea.height[:, 0])


def plain(order: int, size: int, steps: int) -> dict[str, Any]:
    """The run in numpy with so many steps a period."""
    wave, elevation, potential = start(size)
    sea = PlainSea(elevation[:, None], potential[:, None], (LENGTH, LENGTH), order, GRAVITY)
    began = effort_clock()
    with np.errstate(all="ignore"):
        sea.advance(PERIODS * LENGTH / wave.speed, PERIODS * steps)
    seconds = (effort_clock() - began) / PERIODS
    return record("numpy, scipy.fft", order, size, steps, seconds, sea.height[:, 0])


def findings(_: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """A sea of 128 x 128 at order 3: a step over its bare transforms, the share of a core, and numpy's time."""
    linear = Sea(SEA_SIZE, 500.0, "jonswap", wind_speed=15.0, fetch=50e3, choppiness=0.0, precision="double")
    sea = NonlinearSea(start=linear, order=SEA_ORDER, rtol=SEA_TOLERANCE, fade=0.0)
    sea.advance(1.0)
    steps, began = sea.steps, effort_clock()
    sea.advance(1.0 + SEA_DURATION)
    share = (effort_clock() - began) / SEA_DURATION
    each = SEA_DURATION / (sea.steps - steps)
    fixed = NonlinearSea(size=SEA_SIZE, length=500.0, order=SEA_ORDER, start=sea.waves_at(), step=each, fade=0.0)
    fixed.advance(each)
    before = fixed.transforms.count
    fixed.advance(2.0 * each)
    count, times = fixed.transforms.count - before, iter(range(3, 10**6))
    bare = bare_transforms(SEA_SIZE, SEA_ORDER, count)
    # The sea's own linear part is exact; numpy's steps at the same tolerance are about as long.
    other = PlainSea(sea.height, sea.potential, (500.0, 500.0), SEA_ORDER, GRAVITY)
    calls = (lambda: fixed.advance(next(times) * each), bare, lambda: other.advance(1e-3, 1))
    spent = np.array([[processor_time(call) for call in calls] for _ in range(SEA_REPEATS)])
    ours_time, bare_time, other_time = np.median(spent, axis=0)
    return [
        {
            "size": SEA_SIZE, "order": SEA_ORDER, "ms a step": ours_time * 1e3, "transforms": count,
            "ratio to transforms": ours_time / bare_time, "step [s]": each, "real time, % of a core": 100.0 * share,
            "numpy over ours": other_time / ours_time, "flow over separable loops": flow_ratio(),
        }
    ]  # fmt: skip


def flow_ratio() -> float:
    """Time of velocity, acceleration and pressure at points over that of two separable sums, in turns."""
    linear = Sea(FLOW_SIZE, 400.0, "sea_state", hs=4.0, tp=10.0, choppiness=0.0)
    sea = NonlinearSea(start=linear, order=SEA_ORDER, breaking=False, fade=0.0)
    random = np.random.default_rng(0)
    across, down = random.uniform(0.0, 400.0, (FLOW_POINTS, 2)), random.uniform(-40.0, -3.0, FLOW_POINTS)
    points, spectrum = np.column_stack([across, down]), np.fft.rfft2(sea.potential.T)[:, :-1] / FLOW_SIZE**2
    calls = (lambda: sea.kinematics(points), lambda: [separable_flow(points, spectrum, 400.0) for _ in range(2)])
    for call in calls:
        call()
    spent = np.array([[processor_time(call) for call in calls] for _ in range(FLOW_REPEATS)])
    ours_time, other_time = np.median(spent, axis=0)
    return float(ours_time / other_time)


def bare_transforms(size: int, order: int, count: int) -> Callable[[], None]:
    """As many transforms as a step of order 3 has, each with its own grid: of 14, two to and one from twice as many
    waves, and three from as many as the sea has."""
    cells = padded_size(size, order)
    own, wide = (PaddedTransforms((cells, cells), columns, Work()) for columns in (size // 2, size))
    grids = np.zeros((14, cells * cells))
    calls = [own.set_grid] * 8 + [wide.set_grid] * 2 + [wide.set_result] + [own.set_result] * 3

    def bare() -> None:
        for i in range(count):
            calls[i % 14](grids[i % 14])

    return bare
