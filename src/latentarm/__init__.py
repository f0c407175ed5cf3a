"""Steer a high-DoF assistive robot arm with a low-DoF input, by latent actions."""

__version__ = "0.1.0"
