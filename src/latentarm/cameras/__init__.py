"""Cameras: their addresses, and pictures from them with the time when each was taken."""
