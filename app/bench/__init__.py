"""`springtide bench`: cases/ holds the benchmarks, tasks/ what Springtide and its peers are both given, peers/ the
other programs, native/ the loops in C.
"""
