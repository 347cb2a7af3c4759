"""The expected engine: computes means over infinitely many records without making any record."""
