"""Lines under water: chains of links in still or moving water above a bed, for every explicit integrator.

`arrays` holds the kernels' record, `forces` what acts, `damping` the exact damping of the split methods, `energy` the
account. The package `sim.mooring` builds the records.
"""
