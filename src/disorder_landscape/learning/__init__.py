"""The network: what it sees, how it is trained, what it predicts."""
