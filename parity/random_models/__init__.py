"""Random models that use all of MJCF that Clench reads, compared with MuJoCo, and cut down where they differ.

`generate` makes a model from a seed, one section after the other (`preamble`, `tree`, `relations`, `actuation`, `sensing`), out of
`values` for attributes and `harmless` for what does not act on motion; `compare` runs both engines on it; `reduce` drops what a
difference does not need; `search` does all of it for many seeds.
"""
