"""Checks of a student's functions and answers, and the names of mistakes."""
