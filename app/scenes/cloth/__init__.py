"""The cloth."""
