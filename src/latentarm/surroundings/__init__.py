"""Perception of the things around an arm: sources of sightings, and tracking."""
