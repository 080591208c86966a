"""Explicit Runge-Kutta pairs with an error estimate, each step fused, and the march that chooses their steps."""
