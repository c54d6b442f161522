"""Tables of the case file that an analysis reads: no solver is imported here."""
