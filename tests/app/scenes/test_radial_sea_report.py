"""What the panel of the radial scene says: the numbers are those of the physics, in every preset."""

import math
import re

import pytest

from app.scenes.radial_sea.parameters import PRESETS, Params
from app.scenes.radial_sea.report import marks_of, notes_of, readout_of
from app.scenes.radial_sea.scene import RadialSeaScene
from app.server.loop import SimLoop
from sim.ocean.fluids import fluids
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


def claims_of(**values) -> dict[str, str]:
    """The statements of a scene by their number, without tags."""
    loop = SimLoop(RadialSeaScene(check_record(Params, values)))
    loop.tick(0.1)
    text = re.sub(r"<[^>]*>", " ", notes_of(loop.latest)["Lab says, physics says"]).replace("\u202f", " ")
    parts = re.split(r"(?<!\d)(1|2, 4|5|6a|6b|7)\. (?=[A-Z])", text)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


@pytest.mark.parametrize("spill", ["none", "layer", "mixed"])
@pytest.mark.parametrize("oil", ["diesel 2002", "Maya", "Bunker C Zalinski"])
def test_reflection_is_that_of_the_oil_and_more_than_the_water_s(spill: str, oil: str) -> None:
    percents = [float(n) for n in re.findall(r"([\d.]+)\s*%", claims_of(spill=spill, oil=oil, fraction=0.4)["7"])]
    third = fluids()[oil].density / 3000.0  # the one-third rule
    index = math.sqrt((1.0 + 2.0 * third) / (1.0 - third))
    assert percents[0] == pytest.approx(100.0 * ((index - 1.0) / (index + 1.0)) ** 2, abs=0.051)
    assert percents[1] == pytest.approx(100.0 * (0.34 / 2.34) ** 2, abs=0.051)
    assert percents[0] > percents[1]
    assert percents[2] > percents[3]


def test_statements_on_oil_are_made_where_there_is_oil() -> None:
    clean = claims_of()
    assert "Nothing is mixed" in clean["5"]
    assert "here:" not in clean["2, 4"]
    assert "After" not in clean["6b"]
    # 2 nu k^2 of sea water at 15 C: 1/(2 x 1.19e-6 x 39.5) s
    assert re.search(r"37\s*% in (3|2.9\d?)\s*h", clean["6b"])
    mixed = claims_of(spill="mixed", fraction=0.4)
    assert "far too low" in mixed["5"]
    assert "far too low" not in claims_of(spill="mixed", fraction=0.05)["5"]
    layer = claims_of(spill="layer", oil="IFO 180", thickness=0.01)
    assert float(re.findall(r"1 m by ([\d.]+)\s*%", layer["6a"])[0]) < 1.0
