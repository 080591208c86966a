"""The oil of the spill: its source, its budget, its chart."""
