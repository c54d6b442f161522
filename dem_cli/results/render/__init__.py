"""Render pictures and movies of results with VTK."""
