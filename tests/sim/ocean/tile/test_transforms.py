"""Plans and their wisdom: kept, found again, and never a reason to fail."""

import numpy as np
import pytest

from sim.ocean import Sea
from sim.ocean.tile import transforms
from sim.ocean.tile.buffer_pool import BufferPool
from sim.ocean.tile.transforms import Transforms, load_wisdom, save_wisdom, wisdom_paths


@pytest.fixture
def cache(tmp_path, monkeypatch):
    import pyfftw

    remembered = pyfftw.export_wisdom()
    pyfftw.forget_wisdom()
    monkeypatch.setenv("SPRINGTIDE_CACHE", str(tmp_path))
    transforms._loaded.clear()
    yield tmp_path
    pyfftw.import_wisdom(remembered)
    transforms._loaded.clear()


def test_wisdom_is_written_once_and_found_again(cache):
    import pyfftw

    Transforms(24, "double")
    assert wisdom_paths()[0].parent == cache
    written = wisdom_paths()[0].read_bytes()
    pyfftw.forget_wisdom()
    assert load_wisdom(wisdom_paths()[0])
    Transforms(24, "double")
    assert wisdom_paths()[0].read_bytes() == written


@pytest.mark.parametrize(
    "text",
    ["", "{", "null", "[]", '{"wisdom": 3}', '{"wisdom": ["*", "", ""]}', '{"wisdom": ["YQ==", "YQ==", "YQ=="]}'],
)
def test_corrupt_wisdom_is_ignored_and_replaced(cache, text):
    wisdom_paths()[0].write_text(text, "utf-8")
    assert not load_wisdom(wisdom_paths()[0])
    assert np.isfinite(Sea(12, 50.0).surface(1.0).height).all()
    assert load_wisdom(wisdom_paths()[0])


def test_unreadable_and_unwritable_wisdom_is_no_error(cache, monkeypatch):
    wisdom_paths()[0].mkdir()  # a directory where the file should be: neither read nor replaced, whoever runs this
    assert not load_wisdom(wisdom_paths()[0])
    assert not save_wisdom(wisdom_paths()[0])
    assert np.isfinite(Sea(12, 50.0).surface(1.0).height).all()
    assert list(cache.iterdir()) == [wisdom_paths()[0]]
    (cache / "file").write_text("", "utf-8")
    monkeypatch.setenv("SPRINGTIDE_CACHE", str(cache / "file" / "below"))
    assert not save_wisdom(wisdom_paths()[0])
    assert np.isfinite(Sea(14, 50.0).surface(1.0).height).all()


@pytest.mark.parametrize("size", [8, 10, 14, 48])
@pytest.mark.parametrize("precision", ["single", "double"])
def test_transform_is_the_plain_inverse_sum(size, precision):
    transform = Transforms(size, precision)
    rng = np.random.default_rng(0)
    grid = rng.normal(size=(size, size))
    planes = transform.grids.take(3)
    for plane in planes:  # of a size no multiple of 4 some begin unaligned
        transform.spectrum[...] = np.fft.rfft2(grid) / size**2
        transform.set_grid(plane)
        assert np.abs(plane - grid).max() < (1e-5 if precision == "single" else 1e-13)
    assert transform.count == 3


def test_grids_are_used_again_only_when_nobody_holds_them():
    grids = BufferPool(8, np.float32)
    first = grids.take(2)
    view = first[1].T[2:]
    address = first.__array_interface__["data"][0]
    del first
    second = grids.take(2)
    assert second.__array_interface__["data"][0] != address
    assert address % 64 == second.__array_interface__["data"][0] % 64 == 0
    del view
    assert grids.take(2).__array_interface__["data"][0] == address
