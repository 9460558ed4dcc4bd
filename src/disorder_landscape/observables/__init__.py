"""What one asks of a wire: conductances, their derivatives, and the topological visibility."""
