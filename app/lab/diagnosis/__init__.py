"""Diagnosis of a wrong function: a step as a tableau of coefficients, a force as a sum of terms.

`steps.py` reads the tableau of a step, `terms.py` the terms of a force; both name the difference from the reference.
"""
