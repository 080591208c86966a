"""The tasks of the course lab: for each a TOML file, and for a function to be written a Python file of that name."""
