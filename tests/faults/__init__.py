"""Planted faults: a committed list of small errors, each tried against the tests that concern its module.

`python -m tests.faults draw` fills the list (`faults.csv`), `run` tries each fault, `table` counts what was found.
"""
