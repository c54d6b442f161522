"""Contact: which faces meet, the contact points between them, and the memory of these points."""
