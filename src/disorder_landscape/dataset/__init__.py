"""Datasets of many wires: what a realization is, shards, files."""
