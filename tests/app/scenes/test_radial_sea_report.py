"""What the panel of the radial scene says: the numbers are those of the physics, in every preset."""

import pytest

from app.scenes.radial_sea.parameters import PRESETS, Params
from app.scenes.radial_sea.report import marks_of, notes_of, readout_of
from app.scenes.radial_sea.scene import RadialSeaScene
from app.server.loop import SimLoop
from sim.parameters import check_record, parameters_of


@pytest.mark.parametrize("name", list(PRESETS))
def test_each_preset_is_reported_without_a_number_that_is_none(name: str) -> None:
    loop = SimLoop(RadialSeaScene(check_record(Params, PRESETS[name])))
    loop.tick(0.1)
    snapshot = loop.latest
    texts = [readout_of(snapshot), *notes_of(snapshot).values(), *marks_of(snapshot).values()]
    assert all(texts)
    assert not any("nan" in text or "inf " in text for text in texts)
    assert set(marks_of(snapshot)) <= set(parameters_of(Params()))


def test_the_extra_sinkage_is_written_with_its_numbers() -> None:
    loop = SimLoop(RadialSeaScene(check_record(Params, PRESETS["Light crude spill 0.2 m"])))
    loop.tick(0.1)
    assert "866/1025" in readout_of(loop.latest)
    assert "0.0310 m" in readout_of(loop.latest)


def test_sinking_bodies_are_said_to_sink() -> None:
    loop = SimLoop(RadialSeaScene(check_record(Params, {"spill": "mixed", "fraction": 0.6, "density": 1010.0})))
    loop.tick(0.1)
    assert "sinks" in readout_of(loop.latest)


def test_no_bodies_and_no_waves_are_reported_too() -> None:
    loop = SimLoop(RadialSeaScene(check_record(Params, {"bodies": 0, "waves": False, "spill": "layer"})))
    loop.tick(0.1)
    assert readout_of(loop.latest) == "No bodies."
    assert all(notes_of(loop.latest).values())
