"""Compilation of kernels, as far as it is not as numba has it."""
