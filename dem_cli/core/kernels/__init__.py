"""Compiled loops over plain arrays; imports nothing but numba, numpy and itself."""
