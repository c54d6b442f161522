"""From a case to its results on disk: one way for the command line and for Python."""
