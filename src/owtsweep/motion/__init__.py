"""Motion of a structure: spectra and their realisations. Knows no sensor and no estimator."""
