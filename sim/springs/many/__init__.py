"""Many ropes at once: ropes of equally many points advance together, one in each lane of the vector registers.

A single rope of ten points fills little more than one register, so that most of its time goes into the ends of loops.
Here the numbers of `WIDTH` ropes lie side by side, (component, point, lane), and every loop runs over points and lanes.

`lanes.py` packs nets into such arrays, `kernels.py` takes the steps, and `advance.py` holds the function to call,
`advance_many`.
"""

from sim.springs.many.advance import METHODS, ManyStates, advance_many, is_plain

__all__ = ["METHODS", "ManyStates", "advance_many", "is_plain"]
