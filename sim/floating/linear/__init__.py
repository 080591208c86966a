"""Linear hydrodynamics: coefficients, datasets, wave forces and responses."""
