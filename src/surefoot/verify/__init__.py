"""Independent checkers; they share no code with what they check."""
