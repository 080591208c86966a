"""Experiments without a browser: sweeps, stability maps, files for artists; their process pool, tables and figures."""
