"""Simulate disordered Majorana nanowires, and read their disorder off their conductance.

A reproduction of Taylor, Sau and Das Sarma, "Machine Learning the Disorder Landscape of Majorana
Nanowires".
"""

from disorder_landscape.arguments import ArgumentError
from disorder_landscape.physics.parameters import Nanowire
from disorder_landscape.physics.transport import conductance, topological_visibility

__all__ = ["ArgumentError", "Nanowire", "conductance", "topological_visibility"]
