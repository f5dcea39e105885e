"""Gymnasium's MuJoCo v5 tasks, one per file: the vector environment, and the single environment based on it."""
