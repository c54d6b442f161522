"""What a run keeps while it goes on, for `--resume`: stages and checkpoints of one run, the journal of many."""
