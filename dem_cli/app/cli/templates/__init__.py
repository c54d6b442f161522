"""Case files that `dem new` prints, one per kind."""
