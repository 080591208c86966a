"""The benchmarks: every module in this folder is one. `benchmarks/command.py` has their contract."""
