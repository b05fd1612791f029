"""The quadruped online: routes, transitions on the real polygons, repair at run time (docs/quadruped.md)."""
