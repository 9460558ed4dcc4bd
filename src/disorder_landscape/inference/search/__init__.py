"""From far to near: the most probable wire and the width of the posterior about it."""
