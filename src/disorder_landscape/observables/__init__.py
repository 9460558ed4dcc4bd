"""What one asks of a wire: conductances, derivatives, T_IV, gaps, density of states, modes."""
