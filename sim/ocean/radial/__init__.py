"""The sum of single waves, `RadialSea`, and the polar grid that seas are drawn on."""
