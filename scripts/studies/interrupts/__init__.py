"""Ctrl-C and SIGTERM at random moments of every command that takes long: how soon it ends, and what it leaves."""
