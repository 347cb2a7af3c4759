"""What the schemes' errors are over the values of one key, for the command `vary`."""
