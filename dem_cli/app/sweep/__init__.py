"""Parameter studies: the plan of a sweep, its runs and its table."""
