"""The processes that run a student's functions."""
