"""Random structures of every generator in fixed and in moving geometry, as drawn and with stones 0.3 mm off."""
