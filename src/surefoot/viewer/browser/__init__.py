"""What every page in the browser stands on: the server, the page that opens from a file, solids, light, recordings."""
