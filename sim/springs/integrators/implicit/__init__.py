"""Common parts of the implicit integrators."""
