"""What `surefoot bench` measures of missions, beside the papers' numbers."""
