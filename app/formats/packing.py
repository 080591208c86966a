"""Values of smooth surfaces in few bits: rounded, predicted from their neighbours, and written as bits.

Points lie in rows of `columns` points. Each value is rounded to a whole number q of steps. The code stores the
difference r = q - (left + above - above left), which is small if the surface is smooth (the Lorenzo predictor;
Ibarria, Lindstrom, Rossignac and Szymczak 2003, "Out-of-core compression and decompression of large n-dimensional
scalar fields"). Missing neighbours count as 0. Each difference becomes a number that is not negative (2 r, or
-2 r - 1). Differences are written in blocks of BLOCK, each with the width of the largest of its block, after
WIDTH_BITS bits for this width.

The result is an array (rows, 3) of single precision, as the vertices of a mesh are: count, columns and fields; then
step, offset and 0 of each field; then the bits, WORD_BITS in each number, lowest first. Words of 30 bits are numbers
from 0 to below 2, so that none is a NaN in transport. `unpack` and `app/render/js/shading/packed.js` read it.
"""

from collections.abc import Sequence

import numpy as np

from sim.jit import kernel
from sim.validation import argument_error

BLOCK = 16
WIDTH_BITS = 5
WORD_BITS = 30
SLOPE_STEP = 1 / 512  # to which slopes of a sea are rounded: its look shows no difference
FOAM_STEP = 1 / 255
MAX_QUOTIENT = 2**20  # of a value and its step: differences then have at most 23 bits


def pack(
    fields: np.ndarray, steps: Sequence[float], columns: int, offsets: Sequence[float] | None = None
) -> np.ndarray:
    """(rows, 3) float32. fields: (m, n), m fields at n points; steps (m,): to which each is rounded, in its unit.

    offsets (m,): added to each field by the reader, by default 0. A step that is below the largest value of its field
    over MAX_QUOTIENT is made larger. Raises ValueError for a value that is not finite.
    """
    values = np.ascontiguousarray(fields, np.float32)
    m, n = values.shape
    bits_of_largest = np.empty(m, np.int32)
    set_largest(values.view(np.int32), bits_of_largest)
    largest = bits_of_largest.view(np.float32)
    if not np.isfinite(largest).all():
        raise argument_error("fields", float(largest[~np.isfinite(largest)][0]), "finite values")
    used = np.maximum(np.asarray(steps, np.float32), largest / np.float32(MAX_QUOTIENT))
    head = 3 + 3 * m
    blocks = -(-n // BLOCK)
    words = np.empty(head + m * blocks * (WIDTH_BITS + 24 * BLOCK) // WORD_BITS + 4, np.uint32)
    words[:head] = 0
    count = write_bits(values, used, columns, np.empty(n, np.int32), np.zeros(blocks * BLOCK, np.int32), words[head:])
    words[head + count : head + count + 2] = 0
    numbers = words.view(np.float32)
    numbers[:3] = n, columns, m
    numbers[3:head:3] = used
    numbers[4:head:3] = 0.0 if offsets is None else offsets
    return numbers[: 3 * -(-(head + count) // 3)].reshape(-1, 3)


def unpack(numbers: np.ndarray) -> np.ndarray:
    """(m, n) float32: the fields that `pack` wrote, each value within half a step; `numbers` as it returned them."""
    flat = np.ascontiguousarray(numbers, np.float32).reshape(-1)
    n, columns, m = (int(number) for number in flat[:3])
    head = 3 + 3 * m
    values = np.empty((m, n), np.float32)
    steps, offsets = flat[3:head:3].copy(), flat[4:head:3].copy()
    read_bits(flat[head:].view(np.uint32), steps, offsets, columns, np.empty(n, np.int32), values)
    return values


def is_packed(numbers: np.ndarray) -> bool:
    """True if an array (rows, 3) of single precision can be a result of `pack`."""
    head = numbers[0]
    if not (np.mod(head, 1.0) == 0.0).all() or not (head > 0.0).all() or head[2] >= len(numbers):
        return False
    words = numbers[1 + int(head[2]) :]
    return bool(((words >= 0.0) & (words < 2.0)).all())


@kernel(inline=True)
def emit(bits, used, words, at, number, length):
    """Add `length` bits, at most 34, to those that wait, fewer than WORD_BITS, and write them.

    Returns (bits, used, at) of the word that is not full yet.
    """
    bits |= number << used
    used += length
    words[at] = np.uint32(bits & np.uint64(2**WORD_BITS - 1))
    if used >= np.uint64(WORD_BITS):
        at += np.uint64(1)
        used -= np.uint64(WORD_BITS)
        bits >>= np.uint64(WORD_BITS)
        words[at] = np.uint32(bits & np.uint64(2**WORD_BITS - 1))
        if used >= np.uint64(WORD_BITS):
            at += np.uint64(1)
            used -= np.uint64(WORD_BITS)
            bits >>= np.uint64(WORD_BITS)
    return bits, used, at


@kernel(noalias=True)
def write_bits(values, steps, columns, q, r, words):
    """Write the fields (m, n), rounded to steps (m,), into words; return how many of these were used.

    q (n,), r (n rounded up to whole blocks,): for the rounded values and their differences; r is 0 from n on.
    """
    fields, n = values.shape
    at, used, bits = np.uint64(0), np.uint64(0), np.uint64(0)  # the word that is written, and its bits that are taken
    for field in range(fields):
        scale = np.float32(1.0) / steps[field]
        value = values[field]
        for i in range(n):
            q[i] = np.int32(np.rint(value[i] * scale))
        for first in range(0, n, columns):  # in slices, for which the compiler uses wide instructions
            last = min(first + columns, n)
            left, right, difference = q[first : last - 1], q[first + 1 : last], r[first + 1 : last]
            r[first] = q[first]
            if first == 0:
                for i in range(last - 1):
                    difference[i] = right[i] - left[i]
            else:
                above_left, above = q[first - columns : last - columns - 1], q[first - columns + 1 : last - columns]
                r[first] -= q[first - columns]
                for i in range(last - first - 1):
                    difference[i] = right[i] - left[i] - above[i] + above_left[i]
        for i in range(n):
            r[i] = (r[i] << 1) ^ (r[i] >> 31)
        for first in range(0, n, BLOCK):
            block = r[first : first + BLOCK]
            together = np.int32(0)
            for i in range(BLOCK):
                together |= block[i]
            width = np.uint64(0)
            while together >> width != 0:
                width += np.uint64(1)
            bits, used, at = emit(bits, used, words, at, width, np.uint64(WIDTH_BITS))
            count = min(n - first, BLOCK)
            if count < BLOCK or width > 17:
                for i in range(count):
                    bits, used, at = emit(bits, used, words, at, np.uint64(block[i]), width)
            elif width > 8:  # two or four numbers at a time have 34 bits at most
                for i in range(0, BLOCK, 2):
                    pair = np.uint64(block[i]) | np.uint64(block[i + 1]) << width
                    bits, used, at = emit(bits, used, words, at, pair, np.uint64(2) * width)
            elif width > 0:
                for i in range(0, BLOCK, 4):
                    low = np.uint64(block[i]) | np.uint64(block[i + 1]) << width
                    high = np.uint64(block[i + 2]) | np.uint64(block[i + 3]) << width
                    four = low | high << np.uint64(2) * width
                    bits, used, at = emit(bits, used, words, at, four, np.uint64(4) * width)
    words[at] = np.uint32(bits)
    return at + np.uint64(1)


@kernel(noalias=True)
def set_largest(values, largest):
    """largest (m,): the magnitudes of the fields (m, n), as bits of single precision; a NaN is above all numbers."""
    for field in range(values.shape[0]):
        value, most = values[field], np.int32(0)
        for i in range(value.size):  # bits of magnitudes are in the order of the magnitudes, and compare at full width
            most = max(most, value[i] & np.int32(0x7FFFFFFF))
        largest[field] = most


@kernel(noalias=True)
def read_bits(words, steps, offsets, columns, q, values):
    """Set the fields (m, n) from words that `write_bits` wrote; q (n,): for the rounded values."""
    fields, n = values.shape
    at, ready = 0, 0  # the next word, and the bits of `bits` that are not read yet
    bits = np.uint64(0)
    for field in range(fields):
        width = 0
        for i in range(n):
            number = 0
            for k in range(0 if i % BLOCK == 0 else 1, 2):
                length = WIDTH_BITS if k == 0 else width
                if ready < length:
                    bits |= np.uint64(words[at]) << np.uint64(ready)
                    at += 1
                    ready += WORD_BITS
                number = np.int32(bits & ((np.uint64(1) << np.uint64(length)) - np.uint64(1)))
                bits >>= np.uint64(length)
                ready -= length
                width = number if k == 0 else width
            value = (number >> 1) ^ -(number & 1)
            if i >= columns:
                value += q[i - columns]
            if i % columns > 0:
                value += q[i - 1]
                if i >= columns:
                    value -= q[i - columns - 1]
            q[i] = value
            values[field, i] = q[i] * steps[field] + offsets[field]


def compile_packing() -> None:
    """Pack two points, and unpack them."""
    unpack(pack(np.zeros((1, 2)), (1.0,), 2))
