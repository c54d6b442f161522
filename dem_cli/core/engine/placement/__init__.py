"""Where blocks are put, and how far they may come from there."""
