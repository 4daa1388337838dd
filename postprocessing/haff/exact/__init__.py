"""References written independently of the solver: exact solutions, equations of state, closures."""
