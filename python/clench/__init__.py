"""MuJoCo's constraint model, fast: one robot or thousands at once."""
