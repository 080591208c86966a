"""One rope of springs."""
