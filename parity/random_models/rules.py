"""The MJCF that Clench reads according to `clench mjcf`, and the part of it that a model uses."""

import functools

import program


@functools.lru_cache(maxsize=None)
def rules():
    """Returns for each element the lists of attributes `read`, `ignored` and `refused`, and its `children`."""
    found = {}
    for line in program.run("mjcf").stdout.splitlines():
        words = line.split()
        if line.startswith(" "):
            rule[words[0]] = words[1:]
        else:
            rule = found[words[0]] = {"read": [], "ignored": [], "refused": [], "children": []}
    return found


def key(parent, element):
    """Returns the name of an element below a parent in the rules."""
    special = f"{parent.tag}/{element.tag}"
    return special if special in rules() else element.tag


def used(root):
    """Yields the pairs of element and attribute of a model, and a pair with None for each element below the root."""
    yield from ((root.tag, attribute) for attribute in root.attrib)
    for parent in root.iter():
        for element in parent:
            name = key(parent, element)
            yield name, None
            yield from ((name, attribute) for attribute in element.attrib)
