"""Write and read results on disk: HDF5, VTKHDF, summary.json, CSV, written during the run."""
