"""Study of buildings: what a house of 1,000 blocks costs from its plan to its report, and 10,000 blocks at rest."""
