"""Numerics of Springtide: springs, oceans, floating bodies, particles. No viewer, no threads, no wall clock."""
