"""Records of a run that solvers hand out, what they are asked for, and the ports through which they tell and stop."""
