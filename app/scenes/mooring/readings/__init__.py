"""What the mooring shows in numbers: tensions, statistics, restoring curve, and their texts."""
