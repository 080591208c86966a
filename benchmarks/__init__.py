"""Other programs and loops in C, given the same tasks as Springtide. In a checkout only: nothing here is installed.

`springtide bench` finds it beside the package: cases/ as further benchmarks, command.py for `--peers`, compare.py for
`--compare`. native/ holds the loops in C, tasks/ the tasks with our own runs of them, peers/ the other programs.
"""
