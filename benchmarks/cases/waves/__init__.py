"""Benchmarks of seas, their waves, fire and jet."""
