"""Pipeline from a case to its results on disk, shared by the command line and Python."""
