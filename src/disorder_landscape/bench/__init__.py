"""The benchmark: how fast the solvers are and how much memory they need."""
