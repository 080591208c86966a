"""Benchmarks of ropes, cloths and their methods."""
