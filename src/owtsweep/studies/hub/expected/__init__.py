"""The expected engine: computes mean errors over infinitely many records without making any."""
