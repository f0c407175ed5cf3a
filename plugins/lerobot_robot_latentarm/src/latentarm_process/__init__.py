"""The process that drives an arm by a run's latent actions, whatever the process that asks for them does.

It imports neither LeRobot nor torch, so it starts in seconds and nothing of theirs makes its loop late.
"""
