"""Draw pictures and charts of results with matplotlib."""
