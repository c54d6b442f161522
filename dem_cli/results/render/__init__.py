"""Rendered pictures and movies of results, by VTK."""
