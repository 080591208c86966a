"""Texts of the panel about the waves of a measured spectrum."""

import functools
from typing import Any

from app.formats.formatting import number
from app.render.markup.html import Html, bold, fill, join
from app.scenes.sea_parameters import notes_on_file, spectrum_in_file


@functools.lru_cache(maxsize=8)
def height_and_period(path: str, time: str) -> tuple[float, float]:
    """Hs [m] and Tp [s] of the measured spectrum in a file."""
    found = spectrum_in_file(path, time).moments()
    return found.significant_height, found.peak_period


def measured_text(params: Any) -> Html:
    """Name, height and period of the measured spectrum of a sea."""
    height, period = height_and_period(params.spectrum_file, params.spectrum_time)
    return fill(
        "<div>Measured, {}: significant height {} m, peak period {} s.</div>",
        spectrum_in_file(params.spectrum_file, params.spectrum_time).title, number(height), number(period),
    )  # fmt: skip


def files_folder(params: Any) -> dict[str, str]:
    """Heading -> HTML of the folder on the file of a measured spectrum; none without one."""
    if not params.spectrum_file:
        return {}
    title = fill("<div>{}</div>", bold(spectrum_in_file(params.spectrum_file, params.spectrum_time).title))
    return {"Files": join((title, *(fill("<div>{}</div>", note) for note in notes_on_file(params))))}
