"""The way from a wanted velocity to the arm: shaping filters and the verified brake."""
