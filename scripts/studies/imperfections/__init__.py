"""The 21-block wall of thesis 5.4 with one block too low."""
