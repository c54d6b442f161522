"""The model of a structure: arrays only."""
