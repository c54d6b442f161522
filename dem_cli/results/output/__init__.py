"""Results on disk: HDF5, VTKHDF, summary.json, CSV; written as a run goes, read back."""
