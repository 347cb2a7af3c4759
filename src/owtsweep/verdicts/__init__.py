"""Compare published numbers and statements with a run; write tables and a report of verdicts."""
