"""What the scenes of springs (rope, race, cloth) share. This folder holds no scene."""
