"""The tasks of the peers: a subject, a reference solution, our own ladders of runs, and `peer_rows`."""
