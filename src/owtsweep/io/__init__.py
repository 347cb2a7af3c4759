"""Reads and writes files: whole or not at all, and tables without loss of any digit."""
