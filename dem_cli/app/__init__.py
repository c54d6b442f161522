"""Application layer: commands, public functions of Python, sweeps, verification, calibration."""
