"""What ``surefoot bench`` prints: the lines of every part, and tables as text."""
