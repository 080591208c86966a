"""Fluids under and on the waves: oils, mixtures, layers, films and slicks."""
