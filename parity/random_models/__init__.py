"""Random models that use all of MJCF that Clench reads, compared with MuJoCo and reduced if they differ.

`generate` makes a model from a seed, section by section (`preamble`, `tree`, `relations`, `actuation`, `sensing`), with
attributes from `values` and, if they do not affect motion, from `harmless`. `compare` runs both engines on it. `reduce`
removes elements that a difference does not need. `search` does all of this for many seeds.
"""
