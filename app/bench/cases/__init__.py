"""The benchmarks. Every module in this folder is one; `app/bench/command.py` holds their contract."""
