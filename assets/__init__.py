"""Data files of the lab, read through importlib.resources."""
