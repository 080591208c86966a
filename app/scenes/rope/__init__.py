"""The rope of springs."""
