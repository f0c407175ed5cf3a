"""What stands between a wanted velocity and the arm: shaping filters and the verified brake."""
