"""The homogeneous model: half the push moves half as fast, and the opposite push goes back."""
