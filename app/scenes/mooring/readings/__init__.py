"""Numbers of the mooring: tensions, statistics, restoring curve, and their texts."""
