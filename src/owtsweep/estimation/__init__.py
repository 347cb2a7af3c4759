"""Linear estimation: filters, smoothers, predictors, horizons. It knows no turbine and no study."""
