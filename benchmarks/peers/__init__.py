"""Peers: other programs that are given the same tasks. A module for each task and kind of program."""
