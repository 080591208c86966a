"""The drawing of bodies, lines, fire and cutaway."""
