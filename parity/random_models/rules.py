"""What Clench says that it reads of MJCF (`clench mjcf`), and what a model uses of it."""

import functools

import program


@functools.lru_cache(maxsize=None)
def rules():
    """For each element, the lists of attributes `read`, `ignored` and `refused`, and its `children`."""
    found = {}
    for line in program.run("mjcf").stdout.splitlines():
        words = line.split()
        if line.startswith(" "):
            rule[words[0]] = words[1:]
        else:
            rule = found[words[0]] = {"read": [], "ignored": [], "refused": [], "children": []}
    return found


def key(parent, element):
    """The name that the rules know an element below a parent by."""
    special = f"{parent.tag}/{element.tag}"
    return special if special in rules() else element.tag


def used(root):
    """Pairs of element and attribute that a model has, and each element below the root alone."""
    yield from ((root.tag, attribute) for attribute in root.attrib)
    for parent in root.iter():
        for element in parent:
            name = key(parent, element)
            yield name, None
            yield from ((name, attribute) for attribute in element.attrib)
