"""Validation of an element of a document at the time it is written.

The file reader decides: it receives only the element, with the settings, classes and materials of the enclosing
document. Required attributes may be added later. References to names are looked up in the document."""

from __future__ import annotations

import difflib
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from xml.parsers import expat

from clench._document import Document, described, file_of, reference_kind
from clench._files import named
from clench.errors import LoadError

# Sections that an element is read with. An element of one of these sections is checked alone.
_AROUND = ("compiler", "option", "size", "default")
# Elements that refer to other documents.
_OTHERS = ("attach", "model", "include")
# Attributes that specify a range, each with the switch that activates it. `range` is also an attribute of lights.
_LIMITED = ("joint", "fixed", "spatial")
_SWITCHES = {
    "range": "limited",
    "ctrlrange": "ctrllimited",
    "forcerange": "forcelimited",
    "actrange": "actlimited",
    "actuatorfrcrange": "actuatorfrclimited",
}


def check(document: Document, ancestors: Sequence[ET.Element], node: ET.Element) -> None:
    """Rejects an invalid element, or an invalid new attribute of it.

    Parameters
    ----------
    document : Document
        The document that contains it.
    ancestors : sequence of xml.etree.ElementTree.Element
        The enclosing elements, the section first.
    node : xml.etree.ElementTree.Element
        The element.

    Raises
    ------
    LoadError
        If MJCF does not have the tag or attribute there, a value is invalid, or a name is undefined.
    """
    from clench._core import Model

    if node.tag in _OTHERS:
        return
    try:
        Model._check(_fragment(document, ancestors, node), _files(document, node))
    except LoadError as error:
        # Errors that the document contained when it was read are reported by `build`.
        if error.element in (node.tag, f'{node.tag} "{node.get("name")}"'):
            raise LoadError(error.message, element=described(document, node)) from None
    _check_names(document, ancestors, node)


def limit(document: Document, node: ET.Element) -> dict[str, str]:
    """Returns the switches of limits whose ranges an element specifies, if neither it specifies them nor the document
    infers them."""
    compilers = document.root.findall("compiler")
    infers = next((value for node in reversed(compilers) if (value := node.get("autolimits"))), "true")
    if infers == "true":
        return {}
    switches = {
        switch: "true" for name, switch in _SWITCHES.items() if name in node.attrib and (name != "range" or node.tag in _LIMITED)
    }
    return {switch: value for switch, value in switches.items() if switch not in node.attrib}


def _fragment(document: Document, ancestors: Sequence[ET.Element], node: ET.Element) -> str:
    """Returns a document with only this element."""
    root = ET.Element("mujoco")
    root.extend(section for section in document.root if section.tag in _AROUND)
    # Classes of attached documents are referred to by name.
    lent = [node for other in document.family() if other is not document for node in other.root.iter("default")]
    if lent and node.tag != "default":
        classes = ET.SubElement(root, "default")
        for name in dict.fromkeys(name for node in lent if (name := node.get("class", "main")) != "main"):
            ET.SubElement(classes, "default", {"class": name})
    assets = ET.SubElement(root, "asset")
    for asset in [asset for other in document.first().family() for asset in other.root.iterfind("asset/*")]:
        # Elements are read with materials of the right names; their appearance does not affect the result.
        if asset.tag == "texture" and asset is not node:
            ET.SubElement(assets, "texture", name=named(asset), type="2d", builtin="flat", width="1", height="1")
        elif asset.tag == "material" and asset is not node:
            ET.SubElement(assets, "material", name=named(asset))
    section = ancestors[0].tag if ancestors else node.tag
    if section in _AROUND:
        return ET.tostring(root, encoding="unicode")
    parent = assets if ancestors and section == "asset" else root
    if ancestors and section != "asset":
        parent = ET.SubElement(root, section)
    if section == "worldbody":
        # The position of an element in the tree does not affect the result.
        parent = ET.SubElement(parent, "body") if len(ancestors) > 1 else parent
    else:
        for ancestor in ancestors[1:]:
            parent = ET.SubElement(parent, ancestor.tag, ancestor.attrib)
    ET.SubElement(parent, node.tag, node.attrib)
    return ET.tostring(root, encoding="unicode")


def _files(document: Document, node: ET.Element) -> dict[str, bytes]:
    """Returns the files in memory that an element names."""
    paths = [value for attribute, value in node.attrib.items() if attribute.startswith("file")]
    names = [path.replace("\\", "/").rpartition("/")[2] for path in paths]
    return {name: document.assets[name] for name in names if name in document.assets}


def _check_names(document: Document, ancestors: Sequence[ET.Element], node: ET.Element) -> None:
    # The contents of replicas and of models that a file attaches are named when the model is built.
    if document.has_copies():
        return
    section = ancestors[0].tag if ancestors else node.tag
    for attribute, name in node.attrib.items():
        kind = reference_kind(section, node, attribute)
        if kind is None or name == "" or (kind == "body" and name == "world"):
            continue
        if document.find(kind, name) is None:
            known = [named(other) for other in document.elements(kind)]
            near = difflib.get_close_matches(name, known, 1)
            hint = f'; did you mean "{near[0]}"?' if near else ""
            raise LoadError(f'there is no {kind} "{name}"{hint}', element=described(document, node))


def located(document: Document, error: LoadError) -> LoadError:
    """Converts an error about a line of a document's text to one about the element on that line."""
    documents = {file_of(name): attached for other in document.family() for name, attached in other.attached.items()}
    of = document if not error.file else documents.get(error.file)
    if error.line is None or of is None:
        return error
    starts: list[int] = []
    parser = expat.ParserCreate()
    parser.StartElementHandler = lambda *_: starts.append(parser.CurrentLineNumber)
    parser.Parse(of.text(), True)
    nodes = [node for line, node in zip(starts, of.root.iter()) if line == error.line]
    return LoadError(error.message, element=described(of, nodes[0])) if nodes else error
