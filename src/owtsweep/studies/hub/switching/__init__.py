"""Supervisory switching: two schemes run side by side, and a supervisor hands out one of them."""
