"""Compiling ahead, in separate processes."""
