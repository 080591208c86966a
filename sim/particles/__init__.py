"""Particles that move through air and meet the surface."""
