"""The guide of the course lab in the panel, and the student's code."""
