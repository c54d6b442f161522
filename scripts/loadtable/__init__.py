"""Failure loads of the case files by every way that the program has, side by side."""
