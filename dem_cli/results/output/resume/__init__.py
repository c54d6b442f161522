"""Checkpoints and journals that a run keeps for `--resume`."""
