"""Judges how well the published results are reproduced: score, statements and report."""
