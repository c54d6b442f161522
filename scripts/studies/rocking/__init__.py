"""Blocks that rock, slide and bounce, against exact motions."""
