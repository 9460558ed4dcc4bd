"""The paper's claims, one by one: what it states, what we measured, and the verdict."""
