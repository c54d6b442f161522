"""Fuzzing: cases drawn at random from seeds, whole and damaged, that `dem check` and `dem run` have to live with."""
