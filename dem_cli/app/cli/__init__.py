"""Implement the `dem` command: one file per subcommand."""
