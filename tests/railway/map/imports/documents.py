"""Small hand-written railML 3.2 documents: a single track that becomes two, with a little of everything along it."""

from __future__ import annotations

from collections.abc import Callable

from safeloc.railway.map.imports.notes import Imported

RAILML = '<railML xmlns="https://www.railml.org/schemas/3.2" version="3.2">'

STATION = f"""<?xml version="1.0" encoding="UTF-8"?>
{RAILML}
  <common id="co">
    <positioning>
      <linearPositioningSystems>
        <linearPositioningSystem id="km" units="km" startMeasure="10" endMeasure="12" linearReferencingMethod="absolute"/>
      </linearPositioningSystems>
    </positioning>
  </common>
  <infrastructure id="is">
    <topology>
      <netElements>
        <netElement id="a" length="1000.250">
          <relation ref="ab"/>
          <relation ref="ac"/>
          <associatedPositioningSystem id="a_aps">
            <intrinsicCoordinate id="a_0" intrinsicCoord="0">
              <linearCoordinate positioningSystemRef="km" measure="10"/>
            </intrinsicCoordinate>
            <intrinsicCoordinate id="a_1" intrinsicCoord="1">
              <linearCoordinate positioningSystemRef="km" measure="11.00025"/>
            </intrinsicCoordinate>
          </associatedPositioningSystem>
        </netElement>
        <netElement id="b" length="400"/>
        <netElement id="c">
          <associatedPositioningSystem id="c_aps">
            <intrinsicCoordinate id="c_0" intrinsicCoord="0">
              <linearCoordinate positioningSystemRef="km" measure="11.5"/>
            </intrinsicCoordinate>
            <intrinsicCoordinate id="c_1" intrinsicCoord="1">
              <linearCoordinate positioningSystemRef="km" measure="11.0003"/>
            </intrinsicCoordinate>
          </associatedPositioningSystem>
        </netElement>
      </netElements>
      <netRelations>
        <netRelation id="ab" navigability="Both" positionOnA="1" positionOnB="0">
          <elementA ref="a"/><elementB ref="b"/>
        </netRelation>
        <netRelation id="ac" navigability="Both" positionOnA="1" positionOnB="1">
          <elementA ref="a"/><elementB ref="c"/>
        </netRelation>
        <netRelation id="bc" navigability="None" positionOnA="0" positionOnB="1">
          <elementA ref="b"/><elementB ref="c"/>
        </netRelation>
      </netRelations>
      <networks>
        <network id="nw"><level id="lv" descriptionLevel="Micro">
          <networkResource ref="a"/><networkResource ref="b"/><networkResource ref="c"/><networkResource ref="ab"/>
        </level></network>
      </networks>
    </topology>
    <functionalInfrastructure>
      <balises>
        <balise id="bg1_2" belongsToBaliseGroup="bg1" numberInGroup="2">
          <spotLocation id="bg1_2_l" netElementRef="a" pos="97.000"/>
        </balise>
        <balise id="bg1_1" belongsToBaliseGroup="bg1" numberInGroup="1">
          <spotLocation id="bg1_1_l" netElementRef="a" pos="100.000"/>
        </balise>
      </balises>
      <baliseGroups>
        <baliseGroup id="bg1" numberOfBalisesInGroup="2" mileageDirection="reverse">
          <spotLocation id="bg1_l" netElementRef="a" pos="100.000" applicationDirection="both"/>
          <isEurobaliseGroup countryID="426" groupID="139" isLinked="true"/>
        </baliseGroup>
        <baliseGroup id="bg2" mileageDirection="nominal">
          <spotLocation id="bg2_l" netElementRef="c" intrinsicCoord="0.5"/>
          <isEurobaliseGroup countryID="426" groupID="140" isLinked="true"/>
        </baliseGroup>
      </baliseGroups>
      <borders>
        <border id="bo1" type="area" isOpenEnd="true">
          <spotLocation id="bo1_l" netElementRef="a" intrinsicCoord="0"/>
        </border>
      </borders>
      <bufferStops>
        <bufferStop id="bu1"><spotLocation id="bu1_l" netElementRef="b" pos="400"/></bufferStop>
      </bufferStops>
      <overCrossings>
        <overCrossing id="tu1" constructionType="tunnel">
          <linearLocation id="tu1_l">
            <associatedNetElement netElementRef="a" posBegin="900" keepsOrientation="true" sequence="1"/>
            <associatedNetElement netElementRef="b" posEnd="50.5" keepsOrientation="true" sequence="2"/>
          </linearLocation>
        </overCrossing>
      </overCrossings>
      <signalsIS>
        <signalIS id="s1">
          <spotLocation id="s1_l" netElementRef="a" applicationDirection="normal">
            <linearCoordinate positioningSystemRef="km" measure="10.95"/>
          </spotLocation>
          <isTrainMovementSignal/>
        </signalIS>
      </signalsIS>
      <speeds>
        <speedSection id="v1" maxSpeed="100">
          <linearLocation id="v1_l" applicationDirection="normal">
            <associatedNetElement netElementRef="b"/>
          </linearLocation>
        </speedSection>
      </speeds>
      <switchesIS>
        <switchIS id="w1" type="ordinarySwitch" continueCourse="left" branchCourse="right">
          <spotLocation id="w1_l" netElementRef="a" intrinsicCoord="1" applicationDirection="normal"/>
          <leftBranch netRelationRef="ab"/>
          <rightBranch netRelationRef="ac"/>
        </switchIS>
      </switchesIS>
      <tracks>
        <track id="tr1" type="mainTrack">
          <name name="1" language="en"/>
          <linearLocation id="tr1_l">
            <associatedNetElement netElementRef="a"/><associatedNetElement netElementRef="b"/>
          </linearLocation>
        </track>
      </tracks>
      <trainDetectionElements>
        <trainDetectionElement id="ac1" type="axleCounter">
          <spotLocation id="ac1_l" netElementRef="b" pos="12.345"/>
        </trainDetectionElement>
      </trainDetectionElements>
    </functionalInfrastructure>
  </infrastructure>
</railML>
"""

Read = Callable[[str], Imported]


def changed(old: str, new: str, document: str = STATION) -> str:
    """The document with one thing in it changed, which must be there once."""
    assert document.count(old) == 1, f"{document.count(old)} x {old}"
    return document.replace(old, new)


def line_of(text: str, document: str = STATION) -> int:
    """The number of the line that holds the text."""
    return document[: document.index(text)].count("\n") + 1
