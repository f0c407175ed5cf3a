from scripted_arms import arm, gantry, oracle, scripted, two_arms

__all__ = ["arm", "gantry", "oracle", "scripted", "two_arms"]
