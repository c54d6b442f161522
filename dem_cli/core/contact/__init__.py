"""Contact: which faces meet, contact points between them, and what these remember."""
