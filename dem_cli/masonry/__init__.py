"""Generate, draw and import masonry structures, and assemble them to a model."""
