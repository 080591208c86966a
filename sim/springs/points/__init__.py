"""Points and lines as kernels have them: their arrays, forces summed to accelerations, loops over links."""
