"""Records of a run: results of the solvers, their requests, and the ports through which they report and stop."""
