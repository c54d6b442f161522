"""Analyses of structures: one file for each kind that a case may name."""
