"""Figures of section 8.1: those of the paper on simulated arms, noise, and the paper beside ours."""
