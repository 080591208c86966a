"""Benchmarks of the lab as it is served: start, frames, controls, the course."""
