"""Linear estimation at two rates: knows no turbine and no study."""
