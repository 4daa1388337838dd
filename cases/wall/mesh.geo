// A tube of 10 cm in N cells: gmsh -setnumber N 250 ...
DefineConstant[ N = {1000, Min 8, Name "cells"} ];
L = 10;

Point(1) = {0, 0, 0};
Point(2) = {L, 0, 0};
Line(1) = {1, 2};
Transfinite Curve {1} = N + 1;

Physical Point("inlet") = {1};
Physical Point("wall") = {2};
Physical Curve("gas") = {1};
