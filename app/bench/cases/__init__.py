"""The benchmarks: one module each, found by being here."""
