"""Texts of the panel about the waves of a measured spectrum."""

import functools
from typing import Any

from app.formats.formatting import number
from app.render.markup.html import Html, bold, fill, join
from app.scenes.sea_parameters import measured_spectrum, notes_on_file
from sim.ocean.spectra import Spectrum


@functools.lru_cache(maxsize=8)
def moments_of(spectrum: Spectrum[Any]) -> Any:
    """Its moments, which a page needs again and again."""
    return spectrum.moments()


def height_and_period(params: Any) -> tuple[float, float]:
    """Hs [m] and Tp [s] of the measured spectrum of a sea."""
    moments = moments_of(measured_spectrum(params))
    return moments.significant_height, moments.peak_period


def measured_text(params: Any) -> Html:
    """Name, height and period of the measured spectrum of a sea."""
    height, period = height_and_period(params)
    return fill(
        "<div>Measured, {}: significant height {} m, peak period {} s.</div>",
        measured_spectrum(params).title, number(height), number(period),
    )  # fmt: skip


def files_folder(params: Any) -> dict[str, str]:
    """Heading -> HTML of the folder on the file of a measured spectrum; none without one."""
    if not params.spectrum_file:
        return {}
    title = fill("<div>{}</div>", bold(measured_spectrum(params).title))
    return {"Files": join((title, *(fill("<div>{}</div>", note) for note in notes_on_file(params))))}
