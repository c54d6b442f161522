"""One page of HTML that holds all of a run, and opens without a network."""
