"""Arithmetic whose last digit is the same on every processor: products, small matrices, elementary functions, rounding.

BLAS and LAPACK add in the order that suits a processor, and NumPy has other exponentials and angles where there is
AVX-512: all of these are right to round-off, and a run that goes on from them for thousands of steps is another run.
"""
