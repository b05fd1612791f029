"""Pictures of walking steps: the phase plane, keyframes, pushes and what may come of them, controllable regions."""
