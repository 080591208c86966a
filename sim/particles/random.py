"""Random numbers inside kernels: a hash of the caller and the time, so that runs repeat."""

import numpy as np

from sim.jit import kernel

SCALE = np.float32(2.0**-24)


@kernel(inline=True)
def uniform(particle, turn, stream):
    """A number in [0, 1) of three whole numbers, float32. Finaliser of MurmurHash3 (Appleby, public domain)."""
    # numba widens sums and products of uint32 to 64 bits: each is cut back.
    mixed = np.uint64(particle) * np.uint64(2654435761) + np.uint64(turn) * np.uint64(2246822519) + np.uint64(stream)
    h = np.uint32(mixed)
    h = np.uint32((h ^ (h >> np.uint32(16))) * np.uint64(2246822507))
    h = np.uint32((h ^ (h >> np.uint32(13))) * np.uint64(3266489909))
    h = np.uint32(h ^ (h >> np.uint32(16)))
    return np.float32(h >> np.uint32(8)) * SCALE
