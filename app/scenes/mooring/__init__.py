"""The mooring: a floating body on lines between the bed and the water's surface."""

from app.scenes.contract import SceneKind
from app.scenes.mooring.files.editing import EDITING
from app.scenes.mooring.line_scene import SERIES
from app.scenes.mooring.parameters import ABOUT, PRESETS, MooringParams, hidden
from app.scenes.mooring.quantities import QUANTITIES
from app.scenes.mooring.scene import (
    CURVES,
    PLOTS,
    advice,
    file_facts,
    is_stable,
    layout,
    needs,
    notes,
    on_use,
    remedy,
    scene_of,
    warm_up,
    warnings,
)

SCENE = SceneKind(
    name="mooring",
    title="Mooring",
    help="<b>Drag the body</b>, or the arrows of anchors and fairleads.",
    params=MooringParams,
    presets=PRESETS,
    about=ABOUT,
    make=scene_of,
    hidden=hidden,
    warm_up=warm_up,
    needs=needs,
    warm_up_on_use=on_use,
    series=SERIES,
    plots=PLOTS,
    curves=CURVES,
    frame_units={
        "points": "m", "body": "m", "rotation": "1", "tension": "N", "surface": "m", "path": "m", "uplift": "1",
    },
    remedy=remedy,
    is_stable=is_stable,
    advice=advice,
    notes=notes,
    warnings=warnings,
    file_facts=file_facts,
    file_editing=EDITING,
    quantities=QUANTITIES,
    layout=layout,
)  # fmt: skip
