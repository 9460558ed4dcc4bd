"""Samples of the exact posterior."""
