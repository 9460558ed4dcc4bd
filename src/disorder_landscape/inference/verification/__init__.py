"""Predicted wires compared with further measurements."""
