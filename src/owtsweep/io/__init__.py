"""Write files whole or not at all, and tables whose numbers are read back exactly."""
