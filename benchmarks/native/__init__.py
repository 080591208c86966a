"""The loops of our kernels in C, to compare with."""
