"""Common parts of the scenes of springs (rope, race, cloth). This folder holds no scene."""
