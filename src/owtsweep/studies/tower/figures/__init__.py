"""Figures of the tower study."""
