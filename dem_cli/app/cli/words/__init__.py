"""Terminal texts: answers, remarks and tables in words."""
