"""Blocks that rock, slide and bounce, against exact motions: docs/rocking.md and its pictures."""
