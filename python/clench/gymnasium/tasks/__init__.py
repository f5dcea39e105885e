"""Gymnasium's MuJoCo v5 tasks, a file each: the vector environment, and the single one over it."""
