"""Values of the cloth for the tasks of the lab: its springs, its strain, the limit of its step."""

from app.messages import Snapshot
from app.scenes.cloth.frame import ClothFrame, ClothReadings
from app.scenes.cloth.parameters import ClothParams
from app.scenes.contract import Measure
from app.scenes.springs.live_values import stability_values


def live_values(snapshot: Snapshot) -> dict[str, Measure]:
    """The numbers of a snapshot."""
    p: ClothParams = snapshot.params
    frame: ClothFrame = snapshot.frame
    readings: ClothReadings = snapshot.readings
    rows, cols = frame.strain.shape
    return stability_values(readings.stability) | {
        "particles": Measure(rows * cols, "1", "Particles"),
        "structural_links": Measure(rows * (cols - 1) + cols * (rows - 1), "1", "Structural springs"),
        "shear_links": Measure(2 * (rows - 1) * (cols - 1), "1", "Shear springs"),
        "bend_links": Measure(rows * (cols - 2) + cols * (rows - 2), "1", "Bend springs"),
        "largest_strain": Measure(100.0 * float(frame.strain.max()), "%", "Largest strain"),
        "cloth_mass": Measure(p.density * p.width * p.length, "kg", "Mass of the cloth"),
    }
