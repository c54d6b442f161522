"""What users read: answers, remarks and tables in words."""
