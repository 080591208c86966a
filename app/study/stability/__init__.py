"""`springtide stability`: stability maps measured by running every integrator, and compared with theory."""
