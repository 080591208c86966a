"""A cloth of springs."""

import functools

from app.scenes.cloth.parameters import ABOUT, PRESETS, ClothParams, hidden
from app.scenes.cloth.quantities import QUANTITIES, ClothInstant
from app.scenes.cloth.scene import PLOTS, SERIES, ClothScene, needs, warm_up
from app.scenes.contract import SceneKind
from app.scenes.springs.divergence import holding_step
from app.scenes.springs.laws import pieces_on_use
from app.scenes.springs.speed_advice import step_warnings

SCENE = SceneKind(
    name="cloth",
    title="Cloth",
    help="<b>Drag the cloth</b> to pull it, or the arrows to move its pins and the sphere.",
    params=ClothParams,
    presets=PRESETS,
    about=ABOUT,
    make=ClothScene,
    make_with_student=ClothScene,
    hidden=hidden,
    warm_up=warm_up,
    needs=needs,
    warm_up_on_use=functools.partial(pieces_on_use, warm_up),
    series=SERIES,
    plots=PLOTS,
    frame_units={"points": "m", "strain": "", "student": "m, a student's cloth beside the program's"},
    quantities=QUANTITIES,
    instant=ClothInstant,
    warnings=lambda scene: step_warnings(scene.motion.method, scene.readings().stability),
    remedy=lambda snapshot: holding_step(snapshot.params.time_step, snapshot.readings.stability),
    is_stable=lambda snapshot: snapshot.readings.stability.share <= 1.0,
)
