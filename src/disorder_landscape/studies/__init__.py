"""Studies: many trainings that differ in a few settings, and the table of what they reach."""
