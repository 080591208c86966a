"""`springtide sweep`: many runs of a scene over its parameters, on all cores or a Dask cluster, into one NetCDF file.

    scene = "rope"                                # rope, race, cloth, square_sea, radial_sea
    seconds = 10.0                                # simulated time of each run
    frames = 1                                    # measured times: 1 is the end only, n are equally spaced from 0
    preset = "Stiff rope"                         # optional: a preset of the scene, or a file FILE.json beside this one
    design = "grid"                               # all combinations; or "random": a Latin hypercube with
    cases = 200                                   #   this number of cases, and
    seed = 1                                      #   this seed of its random numbers

    [set]                                         # parameters that are the same in every case
    points = 20

    [parameters]                                  # parameters that are swept
    integrator = ["leapfrog", "rk4"]
    time_step = { from = 1e-3, to = 0.05, count = 12, log = true }   # no count in a random design

A case is measured at the first whole step at or after each time. `spec.py` reads the file, `design.py` makes the cases,
`case.py` runs one case and `workers.py` many, `store.py` stores finished cases, `results.py` and `figure.py` write the
results.
"""
