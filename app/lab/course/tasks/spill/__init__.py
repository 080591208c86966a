"""Section 1.1 of the course lab: oil on water, and bodies in it."""
