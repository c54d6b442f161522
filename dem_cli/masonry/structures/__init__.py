"""Generators of structures: walls, columns, arches."""
