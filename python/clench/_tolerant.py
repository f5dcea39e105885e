"""Text that TinyXML, MuJoCo's parser, accepts beyond XML, as the engine reads it."""

from __future__ import annotations

import html
import re
import xml.etree.ElementTree as ET

_QUOTED = r"\"[^\"]*\"|'[^']*'"
_SKIPPED = r"<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>|<!.*?>"
_PIECE = re.compile(rf"({_SKIPPED})|<(?:[^<>\"']|{_QUOTED})*>", re.DOTALL)
_VALUE = re.compile(rf"=\s*({_QUOTED})")
_BARE = re.compile(r"&(?!(?:lt|gt|amp|quot|apos|#\d+|#x[0-9a-fA-F]+);)")
_CONTROL = re.compile("[\x01-\x08\x0b\x0c\x0e-\x1f]")
_MESH = re.compile(rf"<mesh\s(?:[^<>\"']|{_QUOTED})*?\bfilename\s*=\s*({_QUOTED})")


def tree(text: str) -> ET.Element:
    """Parses a text.

    Raises
    ------
    xml.etree.ElementTree.ParseError
        If neither parser accepts it.
    """
    try:
        return ET.fromstring(text)
    except ET.ParseError as error:
        try:
            return ET.fromstring(_strict(text))
        except ET.ParseError:
            raise error from None


def root_name(text: str) -> str:
    """Returns the name of the first element, or "" if there is none."""
    tags = (match[0] for match in _PIECE.finditer(text) if not match[1])
    found = re.match(r"<([^\s/>]*)", next(tags, ""))
    return found[1] if found else ""


def meshes_of_urdf(text: str) -> list[str]:
    """Returns the names of mesh files."""
    return [html.unescape(value[1:-1]) for value in _MESH.findall(text)]


def _strict(text: str) -> str:
    """Converts the first element to strict XML with the same line numbers."""
    text = text.removeprefix("\ufeff").partition("\0")[0]
    out: list[str] = []
    end = depth = 0
    for match in _PIECE.finditer(text):
        tag = "\n" * match[0].count("\n") if match[1] else _VALUE.sub(_value, match[0])
        out += ["\n" * text.count("\n", end, match.start()), tag]
        end = match.end()
        if not match[1]:
            depth += -1 if tag.startswith("</") else not tag.endswith("/>")
            if depth <= 0:
                break
    return "".join(out)


def _value(match: re.Match[str]) -> str:
    value = _CONTROL.sub("\ufffd", _BARE.sub("&amp;", match[1]).replace("<", "&lt;"))
    return f"={value} "
