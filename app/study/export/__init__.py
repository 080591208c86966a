"""Sequences of files for programs of artists: the square sea as pictures that tile, the cloth as meshes."""
