"""The drawing that rope, race and cloth share."""
