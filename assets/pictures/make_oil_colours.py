"""Draw `oil_colours.svg` in this folder: the colour of a film of crude against its thickness, with the Bonn classes.

Run as `python assets/pictures/make_oil_colours.py`. Each stripe has the light that comes up through the film and the
light of an even sky that it mirrors straight up, by `sim/ocean/fluids/oil_film.py`, for the water and oil of the radial
sea.
"""

from pathlib import Path

import numpy as np

from app.render.material import Material, linear
from sim.ocean.fluids.fluids import fluids
from sim.ocean.fluids.oil_film import APPEARANCES, light_through, mirrored_light

OIL = "Alaska North Slope 2002"
SKY = np.array([0.75, 0.85, 1.0]) * 2.5  # radiance of the sky, linear, over that of a white body in its light
WIDTH, HEIGHT, LEFT, TOP = 900, 235, 30, 50  # [pixels] of the chart, and of its corner
STRIPES = 420
SMALLEST, LARGEST = 1e-8, 1e-3  # [m]


def colours(thickness: np.ndarray) -> np.ndarray:
    """(n, 3) sRGB in 0..255 of films (n,) [m] seen from straight above."""
    oil, water = fluids()[OIL], Material()
    rgb = tuple(int(oil.colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    through = light_through(thickness)
    body = through * linear(water.deep_color) + (1.0 - through) * linear((rgb[0], rgb[1], rgb[2]))
    light = body + SKY * mirrored_light(thickness, oil.refractive_index, water.refractive_index)
    return np.round(255.0 * np.clip(light, 0.0, 1.0) ** (1.0 / 2.2)).astype(int)


def chart() -> str:
    """The SVG."""
    span = np.log10(LARGEST / SMALLEST)

    def place(thickness: float) -> float:
        return LEFT + (WIDTH - 2 * LEFT) * float(np.log10(thickness / SMALLEST)) / span

    edges = np.geomspace(SMALLEST, LARGEST, STRIPES + 1)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" '
        'font-size="13">',
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
        f'<text x="{LEFT}" y="24" font-size="15">Film of {OIL} on deep water, from straight above</text>',
    ]
    for low, high, (r, g, b) in zip(edges[:-1], edges[1:], colours(np.sqrt(edges[:-1] * edges[1:])), strict=True):
        width = place(high) - place(low) + 0.3
        parts.append(f'<rect x="{place(low):.1f}" y="{TOP}" width="{width:.1f}" height="90" fill="rgb({r},{g},{b})"/>')
    for row, (name, least) in enumerate(APPEARANCES.items()):
        x, y = place(least), TOP + 110 + 18 * (row % 3)
        parts.append(f'<line x1="{x:.1f}" y1="{TOP}" x2="{x:.1f}" y2="{y}" stroke="black"/>')
        side, anchor = (4, "start") if x < 0.8 * WIDTH else (-4, "end")
        parts.append(f'<text x="{x + side:.1f}" y="{y}" text-anchor="{anchor}">{name}, from {least * 1e6:g} µm</text>')
    for power in range(-8, -2):
        x = place(10.0**power)
        label = f"{10.0 ** (power + 6):g} µm"
        parts.append(f'<text x="{x:.1f}" y="{HEIGHT - 8}" text-anchor="middle" fill="#555">{label}</text>')
    return "\n".join([*parts, "</svg>", ""])


if __name__ == "__main__":
    Path(__file__).with_name("oil_colours.svg").write_text(chart(), "utf-8")
