"""Masonry: structures that are generated, drawn or imported, and how they become a model."""
