"""The expected engine: it computes the mean over infinitely many records without any record."""
