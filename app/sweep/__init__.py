"""`springtide sweep`: many runs of a scene over its parameters, on all cores or a Dask cluster, into one NetCDF file.

    scene = "rope"                                # rope, race, cloth, square_sea, radial_sea
    seconds = 10.0                                # simulated time of each run
    frames = 1                                    # times measured: 1 is the end alone, n are equally spaced from 0
    preset = "Stiff rope"                         # optional: one of the scene's presets, as a start
    design = "grid"                               # every combination; or "random": a Latin hypercube of
    cases = 200                                   #   so many cases,
    seed = 1                                      #   drawn from this seed

    [set]                                         # parameters that are the same in every case
    points = 20

    [parameters]                                       # parameters that are swept
    integrator = ["leapfrog", "rk4"]
    time_step = { from = 1e-3, to = 0.05, count = 12, log = true }   # no count in a random design

A case is measured at the first whole step at or after each time. `spec.py` reads this, `design.py` makes the cases,
`case.py` runs one, `workers.py` many, `store.py` keeps what is finished, `results.py` and `figure.py` show it.
"""
