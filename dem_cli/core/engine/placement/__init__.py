"""Placement of blocks, and their clearance: motion until gaps of the start have closed."""
