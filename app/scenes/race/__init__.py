"""Ropes side by side, each with its own method of integration."""

import functools

from app.scenes.contract import SceneKind, StabilityMap
from app.scenes.race.charts import CURVES
from app.scenes.race.parameters import ABOUT, PRESETS, RaceParams, hidden
from app.scenes.race.quantities import QUANTITIES
from app.scenes.race.scene import RaceScene, needs, warm_up
from app.scenes.springs.laws import pieces_on_use
from app.scenes.springs.rope_parameters import build_rope, stiffness_parameter
from app.scenes.springs.speed_advice import step_warnings
from sim.springs import INTEGRATORS

SCENE = SceneKind(
    name="race",
    title="Race of ropes",
    help="<b>Drag a rope</b> to pull all of them alike.",
    params=RaceParams,
    presets=PRESETS,
    about=ABOUT,
    opening="Shaken at the root",
    make=RaceScene,
    hidden=hidden,
    warm_up=warm_up,
    needs=needs,
    warm_up_on_use=functools.partial(pieces_on_use, warm_up),
    series=(),
    plots={},
    curves=CURVES,
    frame_units={"ropes": "m, side by side", "references": "m"},
    stability_map=StabilityMap(stiffness_parameter, build_rope),
    quantities=QUANTITIES,
    warnings=lambda scene: [
        f"Rope {one.number}: {said}"
        for one in scene.readings().results
        for said in step_warnings(INTEGRATORS[one.integrator], one.gauge)
    ],
)
