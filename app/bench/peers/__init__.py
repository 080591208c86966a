"""Other programs given the same tasks."""
