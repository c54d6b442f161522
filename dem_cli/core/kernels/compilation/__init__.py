"""Compilation of kernels by numba, and what this package adds to it."""
