"""Generate columns: of blocks, of round drums, and rows of these with what they carry."""
