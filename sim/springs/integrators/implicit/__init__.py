"""What the implicit integrators share."""
