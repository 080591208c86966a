"""Analysis of a spring network: energies, growth, settling, reference runs."""
