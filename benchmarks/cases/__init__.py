"""Benchmarks of parts, some against C. Every module in this folder is one; `app/bench/command.py` has the contract."""
