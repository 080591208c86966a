"""The server: threads, the simulation loop, and the guard of browser messages."""
