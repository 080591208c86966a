"""The square sea as a user of another program would write it: height and two displacements at a new time.

A peer's `make(sea)` gives frame(t) -> (3, N, N) [m], or None where it draws another sea and can only be timed.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from app.bench.peers.record import Peer
from sim.ocean import Sea

Frame = Callable[[float], Any]


def wave_numbers(sea: Sea) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """i k/|k| of each axis and the frequencies, (N, N), FFT order."""
    n = np.fft.fftfreq(sea.size, 1.0 / sea.size)
    kx, ky = np.meshgrid(n, n, indexing="ij")
    k = np.hypot(kx, ky)
    k[0, 0] = 1.0
    return 1j * kx / k, 1j * ky / k, sea.frequencies


def mirrored(h0: np.ndarray) -> np.ndarray:
    """conj(h0(-k))."""
    return np.conj(np.roll(h0[::-1, ::-1], 1, axis=(0, 1)))


def student(sea: Sea) -> Frame:
    """Complex double arrays and full inverse transforms: the formulas of the textbook, as a student writes them."""
    h0 = sea.amplitudes_at(0.0)
    other = mirrored(h0)
    x, y, omega = wave_numbers(sea)

    def frame(t: float) -> np.ndarray:
        h = h0 * np.exp(-1j * omega * t) + other * np.exp(1j * omega * t)
        return np.stack([np.fft.ifft2(g).real for g in (h, x * h, y * h)]) * h.size

    return frame


def halves(sea: Sea) -> tuple[np.ndarray, ...]:
    """Half planes in single precision: h0, conj(h0(-k)), i kx/k, i ky/k; and the frequencies in double."""
    h0 = sea.amplitudes_at(0.0)
    half = sea.size // 2 + 1
    x, y, omega = wave_numbers(sea)
    single = [a[:, :half].astype(np.complex64) for a in (h0, mirrored(h0), x, y)]
    return (*single, omega[:, :half])


def scipy_half(sea: Sea) -> Frame:
    """scipy.fft on single-precision half planes, one worker."""
    from scipy import fft  # type: ignore[import-not-found]

    h0, other, x, y, omega = halves(sea)

    def frame(t: float) -> np.ndarray:
        turn = np.exp(-1j * (omega * t)).astype(np.complex64)
        h = h0 * turn + other * np.conj(turn)
        fields = (fft.irfft2(g, s=(sea.size, sea.size), norm="forward") for g in (h, x * h, y * h))
        return np.stack([np.asarray(field) for field in fields])

    return frame


def jax_half(sea: Sea) -> Frame:
    """jax, compiled, single precision."""
    import jax  # type: ignore[import-not-found]
    import jax.numpy as jnp  # type: ignore[import-not-found]

    h0, other, x, y, omega = (jnp.asarray(a) for a in halves(sea))

    @jax.jit
    def fields(phase):
        turn = jnp.exp(-1j * phase).astype(jnp.complex64)
        h = h0 * turn + other * jnp.conj(turn)
        return jnp.stack([jnp.fft.irfft2(g, s=(sea.size, sea.size), norm="forward") for g in (h, x * h, y * h)])

    turns = np.asarray(omega, dtype=np.float64)

    def frame(t: float) -> np.ndarray:
        return np.asarray(fields(jnp.asarray(np.mod(turns * t, 2 * np.pi).astype(np.float32))))

    return frame


def blender(sea: Sea) -> Frame:
    """Blender's Ocean modifier of as many points, evaluated and read back. Another sea: timed only."""
    import bpy  # type: ignore[import-not-found]

    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh = bpy.data.meshes.new("sea")
    thing = bpy.data.objects.new("sea", mesh)
    bpy.context.collection.objects.link(thing)
    ocean = thing.modifiers.new("ocean", "OCEAN")
    ocean.geometry_mode = "GENERATE"
    # Its grids have resolution squared points a side.
    ocean.viewport_resolution = ocean.resolution = round(sea.size**0.5)
    ocean.choppiness = 1.0
    points = np.zeros(0, np.float32)

    def frame(t: float) -> None:
        nonlocal points
        ocean.time = t
        view = thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
        if points.size != 3 * len(view.vertices):
            points = np.empty(3 * len(view.vertices), np.float32)
        view.vertices.foreach_get("co", points)

    return frame


PEERS = (
    Peer("numpy complex128, ifft2", "numpy", student),
    Peer("scipy.fft single, half plane", "scipy", scipy_half),
    Peer("jax single, half plane", "jax", jax_half),
    Peer("Blender Ocean modifier", "bpy", blender),
)
