"""Commands on hulls: their facts, and their hydrodynamics by boundary elements."""
