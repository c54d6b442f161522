"""Geometry in numpy: polygons, topology, rotation, profiles."""
