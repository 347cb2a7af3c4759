"""Loads on the turbine: wind at the top, waves on the wetted part."""
