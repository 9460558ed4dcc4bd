"""What a wire is: parameters, Hamiltonian, disorder, and the names and units of what varies."""
