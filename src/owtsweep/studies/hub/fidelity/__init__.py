"""How well the published results are reproduced: score, calibration, statements, report."""
