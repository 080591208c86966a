"""What is measured or computed about a net: energies, growth, settling, reference runs."""
