"""Starts of a nonlinear sea: Stokes waves, packets, and the waves of any sea."""
