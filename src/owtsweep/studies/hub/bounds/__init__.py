"""The least errors that estimators can have at all, with and without knowledge of the motion."""
