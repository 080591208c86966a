"""A cloth of springs."""
