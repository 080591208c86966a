"""Ropes side by side."""
