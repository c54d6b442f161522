"""Verify cases against their references, and write the page of results."""
