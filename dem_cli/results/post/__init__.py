"""Pictures and charts of results, by matplotlib."""
