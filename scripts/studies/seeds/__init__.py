"""Results of the seeds: every number that the thesis and the two papers print, and what dem says of it."""
