"""Safety checks as codes ask for them, from a capacity curve and a response spectrum."""
