"""`springtide stability`: maps measured by letting every integrator run, beside what theory says of it."""

# What becomes of a disturbance, as `sim.springs.growth` numbers it. Told apart in grey as well: light, middle, dark.
OUTCOMES = {"holds": "#CFE6F5", "rattles": "#E69F00", "explodes": "#8C2D04"}
