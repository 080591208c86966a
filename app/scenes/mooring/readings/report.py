"""Texts of the mooring's panel."""

import math
from collections.abc import Sequence
from pathlib import PureWindowsPath

from app.formats.formatting import counted, metres, number, percent, seconds
from app.messages import Snapshot
from app.render.markup.html import ERROR_COLOUR, WARNING_COLOUR, Html, bold, coloured, faint, fill, info, join, table
from app.scenes.mooring.files.from_file import opened
from app.scenes.mooring.frame import EndStatistics, LineReading, MooringReadings
from app.scenes.mooring.parameters import MooringParams
from app.scenes.mooring.quantities import QUANTITIES, load_use
from app.scenes.mooring.start_check import BLAMED, Fault, raised_points
from app.scenes.quantities import read, written
from app.scenes.springs.drawing.html import colour_scale, step_mark
from sim.numerics.extreme_values import LEAST_PEAKS

TENSIONS, BED = "Tensions", "Bed and slack"  # headings
EXPECTED = f"3 h: largest tension expected in three hours, by a Weibull distribution of at least {LEAST_PEAKS} peaks."
COLOURS = "Brown parts of a line lie on the bed. A red anchor is pulled upwards."


LEAST_DURATION = 1.0  # [s] of the statistics of a run that has stopped, to be shown
NOISE = 1e-4  # of a line's tension, below which a part of it is shown as 0


def kilonewtons(force: float) -> str:
    """A force [N] in kN."""
    return number(1e-3 * force)


def part_of_tension(force: float, tension: float) -> str:
    """A part [N] of a tension [N] in kN; rounding is no force."""
    return "0" if abs(force) < NOISE * abs(tension) else kilonewtons(force)


def figures_of(snapshot: Snapshot) -> str:
    """The fault of the start, or else the largest tension so far."""
    readings: MooringReadings = snapshot.readings
    if readings.fault is not None and not snapshot.status.halted:  # which says it all
        return coloured(readings.fault.short, WARNING_COLOUR)
    most, used = (read(QUANTITIES, name, snapshot) for name in ("largest_tension", "breaking_load_use"))
    use = "" if math.isnan(used) else fill(", {} of breaking load", percent(used))
    return fill("Largest tension: {} kN{}", bold(kilonewtons(most)), use)


def slack_text(reading: LineReading, now: float) -> Html:
    """Time since a line went slack, or the fraction of time that it was slack."""
    if math.isnan(reading.slack_since):
        return fill("{}", percent(reading.slack_fraction) if reading.slack_fraction > 0.0 else "never")
    return coloured(f"since {seconds(now - reading.slack_since)}", ERROR_COLOUR)


def expected_text(force: float) -> str:
    """An expected largest tension [N] in kN; a dash for too few peaks."""
    return "–" if math.isnan(force) else kilonewtons(force)


def tension_table(name: str, ends: Sequence[tuple[float, EndStatistics]], params: MooringParams) -> Html:
    """Tensions at one end of all lines: now, and their statistics, with their use if the breaking load is known."""
    columns = [(name, ""), *((word, "kN") for word in ("now", "min", "mean", "max", "SD", "3 h"))]
    rows = [
        [i + 1, *map(kilonewtons, (now, of.least, of.mean, of.largest, of.deviation)), expected_text(of.expected)]
        for i, (now, of) in enumerate(ends)
    ]
    if params.breaking_load > 0.0:
        columns.append(("use", "%"))
        for row, (_, of) in zip(rows, ends, strict=True):
            row.append(number(100.0 * load_use(of.largest, params), 2))
    return table(columns, rows)


def tension_tables(snapshot: Snapshot) -> Html:
    """The tensions at the fairleads of all lines, and those at their anchors."""
    readings: MooringReadings = snapshot.readings
    params = snapshot.params
    fairleads = [(one.fairlead, one.at_fairlead) for one in readings.lines]
    anchors = [(one.anchor, one.at_anchor) for one in readings.lines]
    return join((tension_table("Fairlead", fairleads, params), tension_table("Anchor", anchors, params)))


def statistics_text(snapshot: Snapshot) -> Html:
    """The time of the statistics, and the largest tension in the time that was left out."""
    duration, start, dragged = (
        read(QUANTITIES, name, snapshot) for name in ("statistics_duration", "statistics_start", "dragged_tension")
    )
    words = fill("Over {} s since t = {} s", number(duration), number(start))
    if not math.isnan(dragged):
        pause = "" if snapshot.readings.counts else ", which are left out until three wave periods have gone by"
        words = fill("{}, without drags{}; while dragged: {} kN", words, pause, bold(kilonewtons(dragged)))
    use = "largest tension over the breaking load" if snapshot.params.breaking_load > 0.0 else "set the breaking load"
    return fill("<div>{}</div>{}", words, faint(fill("SD: standard deviation. {} Use: {}.", EXPECTED, use)))


def bed_table(snapshot: Snapshot) -> Html:
    """Length on the bed, uplift at the anchors and slack, by line."""
    readings: MooringReadings = snapshot.readings
    columns = (("Line", ""), ("Uplift", "kN"), ("largest", "kN"), ("On the bed", "m"), ("Slack", ""))
    rows = [
        (i + 1, part_of_tension(one.uplift, one.fairlead), part_of_tension(one.most_uplift, one.at_fairlead.largest),
         number(one.lying), slack_text(one, snapshot.frame.time))
        for i, one in enumerate(readings.lines)
    ]  # fmt: skip
    return table(columns, rows)


def offset_text(snapshot: Snapshot) -> Html:
    """Offset and watch circle."""
    now, largest = (bold(written(QUANTITIES, name, snapshot)) for name in ("offset", "largest_offset"))
    return fill("<div>Offset {}, watch circle of {} radius</div>", now, largest)


def notes_of(snapshot: Snapshot) -> dict[str, str]:
    """Heading -> HTML of the folders below the controls."""
    said = faint("Slack: the fraction of time, or since when, in which a segment of the line is not stretched.")
    if snapshot.status.halted and read(QUANTITIES, "statistics_duration", snapshot) < LEAST_DURATION:
        stopped = faint("The run stopped at its start: there are no statistics.")
        notes: dict[str, str] = {TENSIONS: stopped, BED: ""}
    else:
        notes = {
            TENSIONS: join((offset_text(snapshot), tension_tables(snapshot), statistics_text(snapshot))),
            BED: join((bed_table(snapshot), said)),
        }
    path = snapshot.params.moordyn_file
    return {"Files": file_text(snapshot.params, snapshot.readings.fault), **notes} if path else notes


def file_text(params: MooringParams, fault: Fault | None) -> Html:
    """The file of the mooring, its changes, and the parts of it without effect here."""
    mooring = opened(params)
    system = mooring.system
    count = fill(
        "<div>{}: {}, {}, {} of them on the vessel, {} deep</div>", bold(PureWindowsPath(params.moordyn_file).name),
        counted(len(system.lines), "line"), counted(len(system.points), "point"), len(mooring.vessel),
        metres(system.water.depth),
    )  # fmt: skip
    said = [] if fault is None else [coloured(fault.said, WARNING_COLOUR)]
    notes = (*said, *mooring.notes, *raised_points(mooring))
    sketch = faint("The vessel is a sketch: the file has no shape, mass or waves for it.")
    return join((count, *(fill("<div>{}</div>", note) for note in notes), sketch))


def readout_of(snapshot: Snapshot) -> Html:
    """The key of the colours."""
    frame = snapshot.frame
    return colour_scale(
        "slack", fill("tension {}", info(COLOURS, "6. Moorings")), f"{kilonewtons(frame.full_scale)} kN",
        clipped=float(frame.tension.max()) > frame.full_scale,
    )  # fmt: skip


def marks_of(snapshot: Snapshot) -> dict[str, str]:
    """Parameter -> the line under its control."""
    readings: MooringReadings = snapshot.readings
    now = readings.stability
    lines = {"time_step": step_mark(now.critical_step, now.accurate_step), **dict.fromkeys(BLAMED, "")}
    is_known = snapshot.params.breaking_load > 0.0
    lines["breaking_load"] = "" if is_known else "unknown: no tension is given as a percentage of it"
    if readings.fault is not None and readings.fault.parameter:
        lines[readings.fault.parameter] = coloured(readings.fault.said, WARNING_COLOUR)
    return lines
