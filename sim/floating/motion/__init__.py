"""Bodies in motion: the fleet, its steps, collisions, and the seas that carry it."""
