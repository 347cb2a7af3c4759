"""Files written whole or not at all; tables whose numbers read back exactly."""
