"""The expected engine: what the mean over infinitely many records would be, without a record."""
