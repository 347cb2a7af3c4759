"""Searches the numbers of a study's schemes on training records, for the command `tune`."""
