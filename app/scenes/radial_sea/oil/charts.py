"""The chart of the radial sea: where the oil of the spill is over five days."""

from functools import lru_cache

import numpy as np

from app.messages import ChartLine
from app.scenes.charts import PALETTE, Chart
from sim.ocean.weathering import Spill, weather
from sim.ocean.weathering.spill import MAX_HOURS

BUDGET_LINES = (  # the first three are stacked: each is drawn over the one before it
    ChartLine("evaporated", PALETTE[5], 1.0, fill="#a9d8f5"),
    ChartLine("drops in the water", PALETTE[2], 1.0, fill="#7fcfb5"),
    ChartLine("on the sea", "#5c3a17", 1.0, fill="#8a5a2b"),
    ChartLine("water in the emulsion", PALETTE[3], 2.5, (6.0, 4.0)),
    ChartLine("now", "#c92a2a", 1.0, fill="#c92a2a"),
)
NOW_WIDTH = 0.6  # [h] of the bar at the time that is shown: a gap ends at the next point, and so needs two
HOURS = np.unique(np.concatenate([np.linspace(0.0, 6.0, 25), np.linspace(6.0, MAX_HOURS, 115)]))  # [h] of its points


@lru_cache(maxsize=8)
def budget_chart(spill: Spill, hours: float) -> Chart:
    """Oil budget from 0 to 120 h [%], stacked; the water in the emulsion [%]; a mark at the time shown [h]."""
    weathering = weather(spill)
    start = min(max(hours - 0.5 * NOW_WIDTH, 0.0), MAX_HOURS - NOW_WIDTH)
    end = start + NOW_WIDTH
    times = np.unique(np.concatenate([HOURS[(start > HOURS) | (end < HOURS)], [start, end]]))
    evaporated, dispersed, water = (
        100.0 * np.interp(times, weathering.hours, values)
        for values in (weathering.evaporated, weathering.dispersed, weathering.water_content)
    )
    now = np.where((times >= start) & (times <= end), 100.0, np.nan)
    whole = np.full(len(times), 100.0)
    left = whole - evaporated - dispersed
    columns = (times, whole, whole - evaporated, left, water, now)
    return Chart("t [h]", BUDGET_LINES, columns, MAX_HOURS, (evaporated, dispersed, left, water, None))
