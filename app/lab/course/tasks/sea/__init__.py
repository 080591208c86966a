"""Section 1.2 of the course lab: the sea, its spectrum and its rain."""
