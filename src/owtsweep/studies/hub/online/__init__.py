"""Schemes as they run on board: each IMU sample gives one estimate."""
