"""The damped kick of the splitting methods: velocities under forces of position and damping together, x held."""
