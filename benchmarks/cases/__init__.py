"""The benchmarks: every module in the folders here is one. `benchmarks/command.py` has their contract."""
