"""The square FFT sea."""

from app.scenes.contract import Awaited, FramePacking, SceneKind
from app.scenes.sea_parameters import notes_on_file
from app.scenes.square_sea.frame import pack_frame, unpack_frame
from app.scenes.square_sea.parameters import ABOUT, PRESETS, SquareSeaParams, hidden, marches
from app.scenes.square_sea.quantities import QUANTITIES, SeaInstant
from app.scenes.square_sea.scene import (
    AWAITED_HINT,
    CURVES,
    HIGH_CREST,
    PLOTS,
    SERIES,
    SquareSeaScene,
    has_high_crest,
    needs,
    pieces_on_use,
    warm_up,
)

SCENE = SceneKind(
    name="square_sea",
    title="Square sea",
    help="<b>Click the water</b> to place a wave gauge; drag to look around.",
    params=SquareSeaParams,
    presets=PRESETS,
    about=ABOUT,
    make=SquareSeaScene,
    make_with_student=SquareSeaScene,
    hidden=hidden,
    warm_up=warm_up,
    needs=needs,
    warm_up_on_use=pieces_on_use,
    series=SERIES,
    plots=PLOTS,
    curves=CURVES,
    frame_units={"vertices": "m", "slopes": "", "foam": "0 to 1"},
    packing=FramePacking(pack_frame, unpack_frame),
    quantities=QUANTITIES,
    notes=notes_on_file,
    instant=SeaInstant,
    awaited=Awaited(f"Run on until a crest of {HIGH_CREST:g} Hs", AWAITED_HINT, marches, has_high_crest),
    middle=lambda params: (0.5 * params.length, 0.5 * params.length),
)
