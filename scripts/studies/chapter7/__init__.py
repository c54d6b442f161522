"""Thesis chapter 7: joints that are not plane."""
