"""The lab around the numerics: viewer, threads, the wall clock, files."""
