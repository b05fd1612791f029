"""Robots' bodies in a scene: simple ones, or their own meshes with the joint angles that the feet ask for."""
