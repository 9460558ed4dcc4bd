"""The physics of one wire: Hamiltonian, leads, solvers, temperature, topology."""
