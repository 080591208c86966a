"""Sections 3 and 4 of the course lab: ropes, cloths, mooring lines, and methods of integration."""
