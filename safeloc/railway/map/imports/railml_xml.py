"""XML of a railML document, read safely, with a record of what was used.

It refuses a document type (and so every entity), excessive nesting and text, and network access. Every element knows its
line. `unused` lists the attributes and elements that no caller has read.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from safeloc.errors import InputError
from safeloc.railway.map.imports.building import content, missing
from safeloc.railway.map.imports.xml_prolog import DOCUMENT_TYPE, refuse_document_type
from safeloc.runtime.outside import refuse_beyond

MOST_ELEMENTS = 2_000_000
MOST_ATTRIBUTES = 10_000_000
"""An element of four bytes and an attribute of six take a hundred times as much memory. The count, of `<` and `=` also in
text and comments, is never below the true number."""
_XSI = "http://www.w3.org/2001/XMLSchema-instance"
_XML = "http://www.w3.org/XML/1998/namespace"


@dataclass(eq=False, slots=True)
class Element:
    """One element: its name without namespace, attributes and children, and which of them were read."""

    tag: str
    namespace: str
    line: int
    text: str
    attributes: dict[str, str]
    children: list[Element]
    used: set[str] = field(default_factory=set)
    seen: bool = False

    @property
    def place(self) -> str:
        """`signalIS 'sig1' line 12`."""
        identity = self.attributes.get("id")
        named = f"{self.tag} {identity!r}" if identity is not None else self.tag
        return f"{named} line {self.line}"

    def get(self, name: str) -> str | None:
        """Return an attribute without surrounding blanks; None if it is missing or empty."""
        self.used.add(name)
        value = self.attributes.get(name, "").strip()
        return value or None

    def need(self, name: str) -> str:
        """Return a required attribute; InputError if it is missing."""
        value = self.get(name)
        if value is None:
            raise InputError(f"{self.place}: attribute {name!r} is missing.")
        return value

    def all(self, *path: str) -> list[Element]:
        """Return the elements of the same namespace at the end of a path below this one; mark all on the path as read."""
        found: list[Element] = [self]
        for tag in path:
            found = [child for one in found for child in one.children if child.is_a(tag, self.namespace)]
            for one in found:
                one.seen = True
        return found

    def one(self, *path: str) -> Element | None:
        """Return the only element at the path, or None; InputError for several."""
        found = self.all(*path)
        if len(found) > 1:
            raise InputError(f"{found[1].place}: there must be one {'/'.join(path)} in {self.place}, not {len(found)}.")
        return found[0] if found else None

    def is_a(self, tag: str, namespace: str) -> bool:
        """Return whether the element has this name."""
        return self.tag == tag and self.namespace == namespace

    def skip(self) -> None:
        """Mark everything in this element as read, since another note covers it."""
        self.seen = True
        self.used |= set(self.attributes)
        for child in self.children:
            child.skip()


def unused(element: Element) -> Iterator[tuple[Element, str | None]]:
    """Yield the unread parts: (element, None) for complete elements, (element, attribute) for single attributes."""
    for name in element.attributes:
        if name not in element.used and name != "id":
            yield element, name
    for child in element.children:
        if child.seen:
            yield from unused(child)
        else:
            yield child, None


def read_xml(path: Path) -> Element:
    """Return the root element of the document. InputError for XML that is not well-formed or not safe to read."""
    data = content(path)
    refuse_document_type(str(path), data)
    refuse_beyond(path, data.count(b"<") - data.count(b"</"), MOST_ELEMENTS, "elements")
    refuse_beyond(path, data.count(b"="), MOST_ATTRIBUTES, "attributes")
    etree = _etree()
    parser = etree.XMLParser(
        resolve_entities=False, load_dtd=False, no_network=True, huge_tree=False, remove_comments=True, remove_pis=True
    )
    try:
        root = etree.fromstring(data, parser)
    except etree.XMLSyntaxError as error:
        raise InputError(f"{path}:{error.lineno}: not well-formed XML ({error.msg}).") from error
    if root.getroottree().docinfo.internalDTD is not None:
        raise InputError(f"{path}: {DOCUMENT_TYPE}")
    return _element(root)


def _etree() -> Any:
    try:
        from lxml import etree  # pyright: ignore[reportAttributeAccessIssue] # compiled, without types
    except ImportError as error:
        raise missing("lxml", "reading railML") from error
    return etree


def _element(node: Any) -> Element:
    namespace, tag = _split(node.tag)
    attributes = {}
    for name, value in node.attrib.items():
        space, local = _split(name)
        if space not in (_XSI, _XML):
            attributes[local if not space else name] = value
    return Element(
        tag, namespace, node.sourceline or 0, (node.text or "").strip(), attributes, [_element(child) for child in node]
    )


def _split(name: str) -> tuple[str, str]:
    """Split `{namespace}local` into both parts."""
    if name.startswith("{"):
        space, _, local = name[1:].partition("}")
        return space, local
    return "", name
