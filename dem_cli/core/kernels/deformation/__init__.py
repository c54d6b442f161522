"""Deformable blocks: uniform strain as further coordinates of a block, for all contact loops."""
