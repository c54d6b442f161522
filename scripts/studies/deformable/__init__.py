"""Study of joints and blocks that deform."""
