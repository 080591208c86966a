"""Links with a table of strain and tension instead of a constant stiffness; they only pull.

Between two rows the tension is linear in the strain, and beyond the last as steep as before it. A table begins at
strain 0 without tension, and both numbers grow from row to row: so the energy is convex, and to each tension belongs
one length.
"""

from sim.jit import kernel


@kernel(allocates=False)
def curve_at(curves, first, count, strain):
    """(tension [N], its derivative by the strain [N], energy per length [N]) at a strain, of rows of `curves`.

    curves: (rows, 3) of `LineArrays`. first, count: of the table, as floats. Of a negative strain all are 0.
    """
    i, last = int(first), int(first) + int(count) - 2
    if strain <= 0.0:
        return 0.0, 0.0, 0.0
    while i < last and strain > curves[i + 1, 0]:
        i += 1
    slope = (curves[i + 1, 1] - curves[i, 1]) / (curves[i + 1, 0] - curves[i, 0])
    beyond = strain - curves[i, 0]
    return curves[i, 1] + slope * beyond, slope, curves[i, 2] + (curves[i, 1] + 0.5 * slope * beyond) * beyond
