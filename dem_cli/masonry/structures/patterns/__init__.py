"""Patterns of irregular masonry: convex panels with holes, filled with stones."""
