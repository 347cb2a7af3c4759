"""Estimate noise, delay and clock offset of recorded sensors from the record itself."""
