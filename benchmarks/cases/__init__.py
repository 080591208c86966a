"""Benchmarks against C. Every module in this folder is one; `app/bench/command.py` says what it must offer."""
