"""The radial sea with floating bodies, oil and a rig."""

from app.scenes.contract import FramePacking, SceneKind
from app.scenes.radial_sea.frame import pack_frame, unpack_frame
from app.scenes.radial_sea.parameters import ABOUT, PRESETS, RadialSeaParams, hidden
from app.scenes.radial_sea.quantities import QUANTITIES
from app.scenes.radial_sea.scene import CURVES, PLOTS, SERIES, RadialSeaScene, needs, warm_up
from app.scenes.sea_parameters import notes_on_file

SCENE = SceneKind(
    name="radial_sea",
    title="Radial sea",
    help="<b>Drag a buoy</b> under the water and let go.",
    params=RadialSeaParams,
    presets=PRESETS,
    about=ABOUT,
    make=RadialSeaScene,
    make_with_student=RadialSeaScene,
    hidden=hidden,
    warm_up=warm_up,
    series=SERIES,
    plots=PLOTS,
    curves=CURVES,
    frame_units={
        "positions": "m",
        "rotations": "quaternion (w, x, y, z)",
        "surface_vertices": "m",
        "surface_slope": "",
        "foam": "0 to 1",
    },
    packing=FramePacking(pack_frame, unpack_frame),
    quantities=QUANTITIES,
    notes=notes_on_file,
    needs=needs,
)
