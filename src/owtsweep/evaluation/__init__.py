"""Running an estimator over measurements, and measuring what it gives."""
