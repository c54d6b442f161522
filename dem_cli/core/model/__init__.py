"""Model of a structure: arrays only."""
