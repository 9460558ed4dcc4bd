"""The compiled core, and what chooses its variant for this CPU."""
