"""Pictures of ground and of what quadrupeds do on it: scans, classes of cells, foothold plans, runs."""
