"""The figures and tables of the hub study."""
