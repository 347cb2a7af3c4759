"""Schemes as they run on board: one sample in, one estimate out, for as long as it takes."""
