"""Joint laws: one contact law per file, with its table of parameters and its source."""
