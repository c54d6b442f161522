"""Ground motion: records, pulses and artificial accelerograms, and their response spectra."""
