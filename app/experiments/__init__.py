"""Common parts of sweep, stability and bench: a process pool, tables and figures."""
