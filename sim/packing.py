"""Values of smooth surfaces in few bits: rounded, predicted from their neighbours, and written as bits.

Points lie in rows of `columns` points. Each value is rounded to a whole number q of steps. What is written is its
difference r = q - (left + above - above left), which is small where the surface is smooth (the Lorenzo predictor;
Ibarria, Lindstrom, Rossignac and Szymczak 2003, "Out-of-core compression and decompression of large n-dimensional
scalar fields"). Neighbours that do not exist count as 0. Each difference is made a number that is not negative (2 r, or
-2 r - 1) and written in blocks of BLOCK of them, with as many bits as the largest of the block needs, after
WIDTH_BITS bits that say how many these are.

The result is an array (rows, 3) of single precision, as the vertices of a mesh are: count, columns and fields; then
step, offset and 0 of each field; then the bits, WORD_BITS in each number, lowest first. Words of 30 bits are numbers
from 0 to below 2, so that nothing on the way meets a NaN. `app/render/js/packed.js` unpacks it.
"""

from collections.abc import Sequence

import numpy as np

from sim.jit import kernel
from sim.validation import argument_error

BLOCK = 16
WIDTH_BITS = 5
WORD_BITS = 30
MAX_QUOTIENT = 2**20  # of a value and its step: differences then have at most 23 bits


def pack(
    fields: np.ndarray, steps: Sequence[float], columns: int, offsets: Sequence[float] | None = None
) -> np.ndarray:
    """(rows, 3) float32. fields: (m, n), m fields at n points; steps (m,): to which each is rounded, in its unit.

    offsets (m,): what the reader adds to each field, by default 0. A step that is below the largest value of its field
    over MAX_QUOTIENT is made larger. Raises ValueError for a value that is not finite.
    """
    values = np.ascontiguousarray(fields, np.float32)
    m, n = values.shape
    largest = np.abs(values).max(axis=1)
    if not np.isfinite(largest).all():
        raise argument_error("fields", float(largest[~np.isfinite(largest)][0]), "finite values")
    used = np.maximum(np.asarray(steps, np.float32), largest / np.float32(MAX_QUOTIENT))
    head = 3 + 3 * m
    blocks = -(-n // BLOCK)
    words = np.zeros(head + m * blocks * (WIDTH_BITS + 24 * BLOCK) // WORD_BITS + 4, np.uint32)
    count = write_bits(values, used, columns, np.empty(n, np.int32), np.empty(BLOCK, np.uint32), words[head:])
    numbers = words.view(np.float32)
    numbers[:3] = n, columns, m
    numbers[3:head:3] = used
    numbers[4:head:3] = 0.0 if offsets is None else offsets
    return numbers[: 3 * -(-(head + count) // 3)].reshape(-1, 3)


def is_packed(numbers: np.ndarray) -> bool:
    """Whether an array (rows, 3) of single precision can be a result of `pack`."""
    head = numbers[0]
    if not (np.mod(head, 1.0) == 0.0).all() or not (head > 0.0).all() or head[2] >= len(numbers):
        return False
    words = numbers[1 + int(head[2]) :]
    return bool(((words >= 0.0) & (words < 2.0)).all())


@kernel(noalias=True)
def write_bits(values, steps, columns, q, block, words):
    """Write the fields (m, n), rounded to steps (m,), into words; return how many of these were used.

    q (n,): for the rounded values; block (BLOCK,): for one block.
    """
    fields, n = values.shape
    at, used = 0, 0  # the word that is written, and its bits that are taken
    for field in range(fields):
        scale = np.float32(1.0) / steps[field]
        for i in range(n):
            q[i] = np.int32(np.rint(values[field, i] * scale))
        for first in range(0, n, BLOCK):
            size = min(BLOCK, n - first)
            together = np.uint32(0)
            for k in range(size):
                i = first + k
                r = q[i]
                if i >= columns:
                    r -= q[i - columns]
                if i % columns > 0:
                    r -= q[i - 1]
                    if i >= columns:
                        r += q[i - columns - 1]
                block[k] = np.uint32((r << 1) ^ (r >> 31))
                together |= block[k]
            width = 0
            while together >> np.uint32(width) != 0:
                width += 1
            for k in range(-1, size):
                bits = np.uint64(width) if k < 0 else np.uint64(block[k])
                length = WIDTH_BITS if k < 0 else width
                word = (bits << np.uint64(used)) | np.uint64(words[at])
                words[at] = np.uint32(word & np.uint64(2**WORD_BITS - 1))
                used += length
                if used >= WORD_BITS:
                    at += 1
                    used -= WORD_BITS
                    words[at] = np.uint32(word >> np.uint64(WORD_BITS))
    return at + 1


def compile_packing() -> None:
    """Pack two points."""
    pack(np.zeros((1, 2)), (1.0,), 2)
