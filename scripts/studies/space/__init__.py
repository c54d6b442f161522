"""Study of failure loads in space: answers by hand, planar twins, walls that meet, published walls."""
