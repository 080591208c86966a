"""Packed values against a plain reader of the same bits."""

import re
from pathlib import Path

import numpy as np
import pytest

from app.formats import packing
from app.formats.packing import BLOCK, MAX_QUOTIENT, WIDTH_BITS, WORD_BITS, is_packed, pack, unpack


def read(numbers: np.ndarray) -> np.ndarray:
    """(fields, count): one bit after the other, and one sum after the other."""
    flat = numbers.reshape(-1)
    count, columns, fields = (int(n) for n in flat[:3])
    head = 3 + 3 * fields
    bits = [(int(word) >> k) & 1 for word in flat.view(np.uint32)[head:] for k in range(WORD_BITS)]
    at = 0

    def take(width: int) -> int:
        nonlocal at
        value = sum(bit << k for k, bit in enumerate(bits[at : at + width]))
        at += width
        return value

    found = np.zeros((fields, count))
    for field in range(fields):
        step, offset = float(flat[3 + 3 * field]), float(flat[4 + 3 * field])
        q: list[int] = []
        for i in range(count):
            if i % BLOCK == 0:
                width = take(WIDTH_BITS)
            z = take(width)
            left = q[i - 1] if i % columns else 0
            above = q[i - columns] if i >= columns else 0
            corner = q[i - columns - 1] if i % columns and i >= columns else 0
            q.append((-(z + 1) // 2 if z % 2 else z // 2) + left + above - corner)
        found[field] = np.array(q) * step + offset
    return found


@pytest.mark.parametrize("count", [1, 15, 16, 17, 100, 257])
@pytest.mark.parametrize("columns", [1, 7, 16, 300])
def test_every_value_comes_back_within_half_a_step(count: int, columns: int) -> None:
    random = np.random.default_rng(count * 1000 + columns)
    # Differences of some 14 and 17 bits, of none, of 6 and of 21: they are written one, two or four at a time.
    fields = np.array([
        random.normal(0.0, 3.0, count), random.uniform(-1e4, 1e4, count), np.zeros(count),
        random.normal(0.0, 3.0, count), random.normal(0.0, 3.0, count),
    ])  # fmt: skip
    steps = (1e-3, 0.5, 0.1, 0.3, 3e-5)
    packed = pack(fields, steps, columns, (10.0, -2.0, 0.0, 0.0, 0.0))
    found = read(packed)
    error = np.abs(found - fields.astype(np.float32) - [[10.0], [-2.0], [0.0], [0.0], [0.0]]).max(axis=1)
    rounding = np.array([1e-3, 1e-3, 1e-3, 1e-3, 5e-2])  # of single precision, over half a step
    assert (error <= 0.5 * np.array(steps) * (1 + rounding)).all()
    np.testing.assert_allclose(unpack(packed), found, rtol=3e-7, atol=1e-6)


def test_a_step_too_small_for_the_values_is_made_larger() -> None:
    fields = np.array([[1e6, -1e6, 1e6, -1e6] * 20])
    found = read(pack(fields, (1e-9,), 3))
    assert np.abs(found - fields).max() <= 0.5 * 1e6 / MAX_QUOTIENT * (1 + 1e-6)


def test_every_word_is_a_small_number() -> None:
    random = np.random.default_rng(3)
    packed = pack(random.normal(0.0, 1e3, (4, 5000)), (1e-4,) * 4, 50)
    assert is_packed(packed)
    assert not is_packed(random.normal(0.0, 1e3, (5000, 3)).astype(np.float32))
    assert packed.dtype == np.float32
    assert packed.shape[1] == 3
    words = packed.reshape(-1)[3 + 3 * 4 :]
    assert (words >= 0.0).all()
    assert (words < 2.0).all()


def test_a_smooth_surface_takes_less_than_a_rough_one() -> None:
    x = np.linspace(0.0, 20.0, 129)
    smooth = np.sin(x[:, None] + 0.5 * x).reshape(1, -1)
    rough = np.random.default_rng(1).permuted(smooth, axis=1)
    assert pack(smooth, (1e-3,), 129).nbytes < 0.6 * pack(rough, (1e-3,), 129).nbytes


def test_values_that_are_not_finite_are_refused() -> None:
    with pytest.raises(ValueError, match="fields: nan is not allowed"):
        pack(np.array([[1.0, float("nan")]]), (1.0,), 2)


def test_the_page_reads_blocks_and_widths_of_the_same_bits() -> None:
    source = (Path(packing.__file__).parents[1] / "render" / "js" / "shading" / "packed.js").read_text("utf-8")
    for name in ("BLOCK", "WIDTH_BITS", "WORD_BITS"):
        assert re.findall(rf"\b{name} = (\d+)", source) == [str(getattr(packing, name))]
