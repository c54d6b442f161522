"""Thesis chapter 6: blocks, a column and an arch that are shaken."""
