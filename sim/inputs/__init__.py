"""Data from elsewhere: what a file is by its content, and what its numbers can be."""
