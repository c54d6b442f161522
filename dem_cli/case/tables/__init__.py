"""Tables of the case file that an analysis reads, kept free of solver imports."""
