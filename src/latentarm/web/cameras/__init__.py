"""Cameras for the page: where their pictures come from, and the process that sends them by WebRTC."""
