"""One-dimensional elements between points of blocks: ties, anchors; one kind, one file."""
