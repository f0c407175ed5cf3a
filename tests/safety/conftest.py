from scripted_arms import arm, coupled, gantry, oracle, robot_named, scripted, two_arms

__all__ = ["arm", "coupled", "gantry", "oracle", "robot_named", "scripted", "two_arms"]
