"""Compares published numbers and statements with a run: intervals, decisions, the report page."""
