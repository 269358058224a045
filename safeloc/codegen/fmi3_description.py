"""modelDescription.xml and buildDescription.xml of an FMI 3.0 co-simulation unit."""

from __future__ import annotations

import uuid
from collections.abc import Sequence
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from safeloc.codegen.c99_layout import Field, Layout
from safeloc.codegen.fmi3_variables import Variable
from safeloc.language.units import Enumeration


def token(layout: Layout) -> str:
    """Return the instantiation token, which links a unit to its description; it is computed from the declaration's digest."""
    return f"{{{uuid.UUID(hex=layout.digest[:32])}}}"


def description(layout: Layout, variables: Sequence[Variable], period_ms: int | None, doc: str) -> str:
    """Return the text of modelDescription.xml."""
    root = Element(
        "fmiModelDescription",
        fmiVersion="3.0",
        modelName=layout.system.name,
        instantiationToken=token(layout),
        description=" ".join(doc.split()),
        generationTool="safeloc",
        variableNamingConvention="flat",
    )
    abilities = {
        "modelIdentifier": layout.names.prefix,
        "canHandleVariableCommunicationStepSize": "true" if period_ms is None else "false",
        "canGetAndSetFMUState": "true",
        "canSerializeFMUState": "true",
    }
    if period_ms is not None:
        abilities["fixedInternalStepSize"] = _seconds(period_ms)
    SubElement(root, "CoSimulation", abilities)
    _types(SubElement(root, "TypeDefinitions"), layout, variables)
    _log_categories(root)
    if period_ms is not None:
        SubElement(root, "DefaultExperiment", startTime="0", stepSize=_seconds(period_ms))
    _variables(SubElement(root, "ModelVariables"), layout, variables)
    _structure(SubElement(root, "ModelStructure"), variables)
    return _text(root)


def build_description(layout: Layout, sources: Sequence[str]) -> str:
    """Return the text of buildDescription.xml, by which the sources are compiled for another platform."""
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = SubElement(root, "BuildConfiguration", modelIdentifier=layout.names.prefix)
    files = SubElement(configuration, "SourceFileSet", language="C99")
    for source in sources:
        SubElement(files, "SourceFile", name=source)
    return _text(root)


def _seconds(period_ms: int) -> str:
    return repr(period_ms / 1000)


def _log_categories(root: Element) -> None:
    categories = SubElement(root, "LogCategories")
    SubElement(
        categories, "Category", name="logStatusDiscard", description="inputs that a step refused, with the reason"
    )
    SubElement(categories, "Category", name="logStatusError", description="calls that the unit cannot follow")


def _types(parent: Element, layout: Layout, variables: Sequence[Variable]) -> None:
    """Declare a type for each unit, since FMI has units for floating-point variables only, and for each enumeration."""
    for unit in dict.fromkeys(one.field.unit for one in variables if one.field.unit):
        SubElement(parent, "Int64Type", name=unit, description=f"whole numbers in {unit}")
    for enumeration in dict.fromkeys(one.enumeration for one in variables if one.enumeration is not None):
        kind = SubElement(parent, "EnumerationType", name=_enumeration_type(layout, enumeration))
        for value, member in enumerate(enumeration.members):
            SubElement(kind, "Item", name=member, value=str(value))


def _enumeration_type(layout: Layout, enumeration: Enumeration) -> str:
    """Return the name of an enumeration's type, with a prefix, since a unit may have the same name."""
    return f"enumeration {layout.names.titles[enumeration]}"


def _variables(parent: Element, layout: Layout, variables: Sequence[Variable]) -> None:
    time = {"name": "time", "valueReference": "0", "causality": "independent", "variability": "continuous"}
    SubElement(parent, "Float64", {**time, "description": "communication point, in s"})
    for variable in variables:
        SubElement(parent, _kind(variable), _attributes(layout, variable))


def _kind(variable: Variable) -> str:
    if variable.is_truth:
        return "Boolean"
    return "Int64" if variable.enumeration is None else "Enumeration"


def _attributes(layout: Layout, variable: Variable) -> dict[str, str]:
    field = variable.field
    attributes = {
        "name": variable.name,
        "valueReference": str(variable.reference),
        "causality": variable.causality,
        "variability": "fixed" if variable.causality == "parameter" else "discrete",
    }
    if variable.description:
        attributes["description"] = variable.description
    if variable.enumeration is not None:
        attributes["declaredType"] = _enumeration_type(layout, variable.enumeration)
    elif field.unit:
        attributes["declaredType"] = field.unit
    if not variable.is_truth:
        attributes |= _bounds(field)
    if variable.start is not None:
        attributes["start"] = str(bool(variable.start)).lower() if variable.is_truth else str(variable.start)
    return attributes


def _bounds(field: Field) -> dict[str, str]:
    """Return the least and the greatest value, including the number that stands in for an absent output."""
    stand_in = field.low if field.stand_in is None else field.stand_in
    return {"min": str(min(field.low, stand_in)), "max": str(max(field.high, stand_in))}


def _structure(parent: Element, variables: Sequence[Variable]) -> None:
    outputs = [str(one.reference) for one in variables if one.causality == "output"]
    for kind in ("Output", "InitialUnknown"):
        for reference in outputs:
            SubElement(parent, kind, valueReference=reference)


def _text(root: Element) -> str:
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"
