"""How a wire is solved: which route, the compiled core, Kwant, and averages over energy."""
