"""Inner parts of viser, and values of its handles."""
