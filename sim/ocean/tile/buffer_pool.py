"""Memory for fields that is used again once nobody holds it.

A fresh megabyte costs the system more than the transform that fills it (measured at 512^2: 1.5 times the transform
alone against 1.15 with reuse), and a sea makes three a frame. A caller may keep a field as long as it likes.
"""

import sys

import numpy as np

ALIGNMENT = 64  # [bytes] what the widest vector instructions like


def references(blocks: list[np.ndarray], i: int) -> int:
    """Number of holders of block i, counted the same way each time."""
    return sys.getrefcount(blocks[i])


UNUSED_REFERENCES = references([np.empty(0)], 0)  # count of a block that only its list holds


class BufferPool:
    """A pool of blocks (count, size, size) of one type."""

    def __init__(self, size: int, real: type) -> None:
        self.size, self.real = size, real
        self._blocks: dict[int, list[np.ndarray]] = {}

    def take(self, count: int) -> np.ndarray:
        """Unset grids (count, size, size), the first of them aligned."""
        blocks = self._blocks.setdefault(count, [])
        for i in range(len(blocks)):
            # Every view of a block, however derived, holds the block itself as its base.
            if references(blocks, i) <= UNUSED_REFERENCES:
                return self._grids(blocks[i], count)
        blocks.append(np.empty(count * self.size**2 * np.dtype(self.real).itemsize + ALIGNMENT, np.uint8))
        return self._grids(blocks[-1], count)

    def _grids(self, block: np.ndarray, count: int) -> np.ndarray:
        start = -block.ctypes.data % ALIGNMENT
        stop = start + count * self.size**2 * np.dtype(self.real).itemsize
        return block[start:stop].view(self.real).reshape(count, self.size, self.size)
