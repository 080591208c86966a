"""Benchmarks of Springtide, and other programs given the same tasks. In a checkout only: not installed.

`python -m benchmarks`, or `springtide bench`, runs them: command.py holds their contract, cases/ the benchmarks,
peers/ the other programs, tasks/ their tasks with our own runs of them, native/ the loops in C, compare.py the
comparison of two commits, labs.py and pupil.py labs with clients. `springtide hydrodynamics --compare` runs
hydrodynamics.py.
"""
