"""What one asks of a wire: conductances, their derivatives, T_IV, gaps, density of states, modes."""
