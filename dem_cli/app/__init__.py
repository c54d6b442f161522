"""The application: commands, public functions of Python, sweeps, verification, calibration."""
