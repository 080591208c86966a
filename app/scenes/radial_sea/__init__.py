"""The radial sea with floating bodies, oil and a rig."""
