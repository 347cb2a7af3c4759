"""Compare published numbers and statements with a run: 95 % intervals, verdicts, report page."""
