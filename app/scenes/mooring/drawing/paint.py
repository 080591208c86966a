"""Colours of the painted parts of the mooring."""

from app.render.material import as_linear_bytes


def linear(colour: tuple[int, int, int]) -> tuple[int, int, int]:
    """A colour, sRGB, as batches take it."""
    red, green, blue = (part / 255.0 for part in colour)
    return as_linear_bytes((red, green, blue))
