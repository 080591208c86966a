"""`springtide bench`. Comparisons with C and with other programs lie in benchmarks/, which is not installed."""
