"""Sequences of files for artists: the square sea as images that tile, the cloth as meshes."""
