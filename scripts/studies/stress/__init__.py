"""The stability stress test: what holds, what is refused, and what would be wrong without a word."""
