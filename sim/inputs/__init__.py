"""Data from elsewhere: the kind of a file by its content, and the bounds of its numbers."""
