"""Pictures of benchmarks and comparisons."""
