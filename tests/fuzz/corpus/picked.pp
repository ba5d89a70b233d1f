<!DOCTYPE PickedPoints>
<PickedPoints>
 <DocumentData>
  <DateTime time="09:30:00" date="2026-01-31"/>
  <DataFileName name="a.ply"/>
 </DocumentData>
 <point x="0" y="0.5" z="-1e3" active="1" name="0"/>
 <point active="0" name="1"/>
 <point x="1" y="1" z="1" active="1" name="2"/>
</PickedPoints>
