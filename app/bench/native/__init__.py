"""The same loops in C, as a floor."""
