"""Hulls: closed meshes, their files and their repair."""
