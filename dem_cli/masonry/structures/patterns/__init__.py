"""Patterns of irregular masonry: rectangles and convex outlines, with holes, filled with stones."""
