"""Links: one-dimensional elements between points of blocks, such as ties, anchors and bars; one kind, one file."""
