"""Safety checks of building codes, from a capacity curve and a response spectrum."""
