"""What is measured, what is unknown, and the probability of one given the other."""
