"""Published numbers and statements held against a run: intervals, decisions, the page."""
