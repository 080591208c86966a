"""One rope of springs."""

from app.scenes.contract import SceneKind, StabilityMap
from app.scenes.rope.parameters import ABOUT, PRESETS, RopeParams, hidden
from app.scenes.rope.quantities import QUANTITIES, RopeInstant
from app.scenes.rope.scene import CURVES, PLOTS, SERIES, RopeScene, build, needs, warm_up, warm_up_on_use
from app.scenes.springs.divergence import holding_step
from app.scenes.springs.rope_parameters import stiffness_parameter
from app.scenes.springs.speed_advice import step_warnings

SCENE = SceneKind(
    name="rope",
    title="Rope",
    help="<b>Drag the rope</b> to pull it, or the arrows to move its root and the sphere.",
    params=RopeParams,
    presets=PRESETS,
    about=ABOUT,
    opening="Shaken at the root",
    make=RopeScene,
    make_with_student=RopeScene,
    hidden=hidden,
    warm_up=warm_up,
    needs=needs,
    warm_up_on_use=warm_up_on_use,
    series=SERIES,
    plots=PLOTS,
    curves=CURVES,
    frame_units={"points": "m", "reference": "m, the program's rope beside a student's", "tension": "N"},
    stability_map=StabilityMap(stiffness_parameter, build),
    warnings=lambda scene: step_warnings(scene.motion.method, scene.readings().stability),
    remedy=lambda snapshot: holding_step(snapshot.params.time_step, snapshot.readings.stability),
    is_stable=lambda snapshot: snapshot.readings.stability.share <= 1.0,
    quantities=QUANTITIES,
    instant=RopeInstant,
)
