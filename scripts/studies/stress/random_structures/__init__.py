"""Random structures: a generator, rigorous bounds of their failure loads, every method of the program against them."""
