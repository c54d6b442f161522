"""A column and arches under pulses of the base, beside published results."""
