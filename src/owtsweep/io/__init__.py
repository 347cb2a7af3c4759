"""Reads and writes files. A file is written whole or not at all; a table loses no digit."""
