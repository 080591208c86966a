"""Moorings at rest: an interior-point method from any start, then Newton's."""
