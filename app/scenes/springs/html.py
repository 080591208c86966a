"""What the panels of rope and cloth say alike, as HTML: the stability gauge, and the scale of the colours."""

from app.render.colormap import css_scale
from sim.springs.stability import Gauge

UNBOUNDED = float("inf")


def stability_bar(gauge: Gauge, *, exact: bool = True) -> str:
    """h omega against the limit; exact: whether h omega is that of the state rather than a bound on it."""
    part = gauge.h_omega / gauge.limit if gauge.limit > 0 else UNBOUNDED
    width, colour = min(part, 1.0) * 100, "#2b8a3e" if part < 0.8 else "#e67700" if part <= 1.0 else "#c92a2a"
    verdict = "stable" if part <= 1.0 else "unstable" if exact else "may be unstable"
    limit = f"limit {gauge.limit:.3g} at ζ = {gauge.zeta:.2g}" if gauge.limit < UNBOUNDED else "no limit"
    sign = "=" if exact else "≤"
    return (
        f'<div style="display:flex;justify-content:space-between"><b>h ω {sign} {gauge.h_omega:.3g}</b>'
        f'<span>{limit}</span><b style="color:{colour}">{verdict}</b></div>'
        '<div style="height:8px;border-radius:4px;background:rgba(128,128,128,.25);margin:2px 0 8px">'
        f'<div style="height:8px;border-radius:4px;width:{width:.0f}%;background:{colour}"></div></div>'
    )


def colour_scale(low: str, name: str, high: str) -> str:
    """The colours from `low` to `high` of what is called `name`."""
    return (
        f'<div style="height:8px;border-radius:4px;background:{css_scale()}"></div>'
        '<div style="display:flex;justify-content:space-between">'
        f"<span>{low}</span><span>{name}</span><span>{high}</span></div>"
    )
