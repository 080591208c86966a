"""The square sea as a user of another program would write it: height and two displacements at a new time.

A peer's `make(sea, precision)` gives frame(t) -> (3, N, N) [m], or None if it draws another sea and can only be
timed.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.peers.record import Peer
from sim.ocean import Sea

Frame = Callable[[float], Any]


TIME = 5.0  # [s] of the frame that is compared
PRECISIONS = ("single", "double")
TYPES = {"single": (np.float32, np.complex64), "double": (np.float64, np.complex128)}


def mirrored(h0: np.ndarray) -> np.ndarray:
    """conj(h0(-k))."""
    return np.conj(np.roll(h0[::-1, ::-1], 1, axis=(0, 1)))


def planes(sea: Sea, columns: int, kind: type) -> tuple[np.ndarray, ...]:
    """h0, conj(h0(-k)), i kx/k and i ky/k in a complex type, and the frequencies in double, (N, columns), FFT order.

    The mean level of our sea at `TIME` is in h0, in equal halves.
    """
    n = np.fft.fftfreq(sea.size, 1.0 / sea.size).astype(np.longdouble)
    kx, ky = np.meshgrid(n, n, indexing="ij")
    k = np.hypot(kx, ky)
    k[0, 0] = 1.0
    h0 = sea.amplitudes_at(0.0).copy()
    h0[0, 0] = 0.5 * sea.mean_height(TIME)
    spectra = [a[:, :columns].astype(kind) for a in (h0, mirrored(h0), 1j * kx / k, 1j * ky / k)]
    return (*spectra, sea.frequencies[:, :columns])


def extended(sea: Sea, t: float) -> np.ndarray:
    """The sums in extended precision, where the machine has one."""
    h0, other, x, y, omega = planes(sea, sea.size, np.clongdouble)
    turn = np.exp(-1j * (omega.astype(np.longdouble) * t))
    h = h0 * turn + other * np.conj(turn)
    return np.stack([np.fft.ifft2(g).real for g in (h, x * h, y * h)]) * h.size


def student(sea: Sea, precision: str) -> Frame:
    """Complex arrays and full inverse transforms: the formulas of the textbook, as a student writes them."""
    kind = TYPES[precision][1]
    h0, other, x, y, omega = planes(sea, sea.size, kind)

    def frame(t: float) -> np.ndarray:
        turn = np.exp(-1j * (omega * t)).astype(kind)
        h = h0 * turn + other * np.conj(turn)
        return np.stack([np.fft.ifft2(g).real for g in (h, x * h, y * h)]) * h.size

    return frame


def scipy_half(sea: Sea, precision: str) -> Frame:
    """scipy.fft on half planes, one worker."""
    from scipy import fft  # type: ignore[import-not-found]

    kind = TYPES[precision][1]
    h0, other, x, y, omega = planes(sea, sea.size // 2 + 1, kind)

    def frame(t: float) -> np.ndarray:
        turn = np.exp(-1j * (omega * t)).astype(kind)
        h = h0 * turn + other * np.conj(turn)
        fields = (fft.irfft2(g, s=(sea.size, sea.size), norm="forward") for g in (h, x * h, y * h))
        return np.stack([np.asarray(field) for field in fields])

    return frame


def jax_half(sea: Sea, precision: str) -> Frame:
    """jax on half planes, compiled."""
    import jax  # type: ignore[import-not-found]

    jax.config.update("jax_enable_x64", True)
    import jax.numpy as jnp  # type: ignore[import-not-found]

    real, kind = TYPES[precision]
    *spectra, omega = planes(sea, sea.size // 2 + 1, kind)
    h0, other, x, y = (jnp.asarray(a) for a in spectra)

    @jax.jit
    def fields(phase):
        turn = jnp.exp(-1j * phase).astype(kind)
        h = h0 * turn + other * jnp.conj(turn)
        return jnp.stack([jnp.fft.irfft2(g, s=(sea.size, sea.size), norm="forward") for g in (h, x * h, y * h)])

    def frame(t: float) -> np.ndarray:
        return np.asarray(fields(jnp.asarray(np.mod(omega * t, 2 * np.pi).astype(real))))

    return frame


def blender(sea: Sea, _: str) -> Frame:
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
    Peer("numpy ifft2", "numpy", student, precisions=PRECISIONS),
    Peer("scipy.fft half plane", "scipy", scipy_half, precisions=PRECISIONS),
    Peer("jax half plane", "jax", jax_half, precisions=PRECISIONS),
    Peer("Blender Ocean modifier", "bpy", blender, precisions=("its own",)),
)
