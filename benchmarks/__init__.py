"""Benchmarks of parts of Springtide, and other programs given the same tasks. In a checkout only: not installed.

`springtide bench` finds it beside the package: cases/ as further benchmarks, command.py for `--peers`, compare.py for
`--compare`. `springtide hydrodynamics --compare` finds hydrodynamics.py. native/ holds the loops in C, tasks/ the tasks
with our own runs of them, peers/ the other programs.
"""
