// A tube of 1 m in N cells, the wall at x = 10 as in ../wall: gmsh -setnumber N 1000 ...
DefineConstant[ N = {500, Min 8, Name "cells"} ];
L = 100;

Point(1) = {10 - L, 0, 0};
// Extruded, not a transfinite line: the cells are then equal to round-off, and so is the mass that flows in.
tube[] = Extrude {L, 0, 0} { Point{1}; Layers{N}; };

Physical Point("inlet") = {1};
Physical Point("wall") = {tube[0]};
Physical Curve("gas") = {tube[1]};
