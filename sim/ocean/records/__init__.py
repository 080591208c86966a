"""Waves from measurements: spectra and records of buoys, and the gauge that makes one."""
