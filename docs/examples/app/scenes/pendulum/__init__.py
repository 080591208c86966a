"""A pendulum on a stiff rod."""

from app.scenes.charts import PlotAxes
from app.scenes.contract import SceneKind
from app.scenes.pendulum.parameters import PRESETS, PendulumParams
from app.scenes.pendulum.scene import QUANTITIES, PendulumScene

SCENE = SceneKind(
    name="pendulum",
    title="Pendulum",
    help="A pendulum on a stiff rod.",
    params=PendulumParams,
    presets=PRESETS,
    about={"Earth": "A pendulum on the Earth.", "Moon": "The same pendulum, slower, on the Moon."},
    make=PendulumScene,
    series=("swing",),
    plots={"plot_swing": PlotAxes("Angle", "rad", ("swing",))},
    quantities=QUANTITIES,
    frame_units={"bob": "m"},
)
