"""Forces of springs, contact and air on the particles of a net."""
