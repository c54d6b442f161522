"""Public Python interface: run, load, open, and the results."""
