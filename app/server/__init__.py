"""The server: threads, the simulation loop, the guard of what browsers send."""
