"""Numbers that the mooring shows: tensions and their statistics, excursion, restoring curve, and the texts."""
