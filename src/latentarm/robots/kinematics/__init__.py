"""Kinematic chains in NumPy and in torch, rotations, and distances between capsules."""
