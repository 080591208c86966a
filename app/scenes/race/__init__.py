"""Ropes side by side, each with its own method of integration."""
