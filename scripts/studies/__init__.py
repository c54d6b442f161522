"""Studies: comparisons of dem with theses, papers, exact motions and itself, one module or sub-package each."""
