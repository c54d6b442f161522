"""Thesis chapter 6, section by section."""
