"""From predicted disorder back to measurements."""
