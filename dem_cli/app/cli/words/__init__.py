"""Format answers, remarks and tables for the terminal."""
