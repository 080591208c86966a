"""The recording of a run, its time line, and files and pictures of it."""
