"""The `dem` command: one file per subcommand."""
