from scripted_arms import arm

__all__ = ["arm"]
