// A tube of length 16 in N cells: gmsh -setnumber N 160 ...
DefineConstant[ N = {640, Min 8, Name "cells"} ];

Point(1) = {0, 0, 0};
Point(2) = {16, 0, 0};
Line(1) = {1, 2};
Transfinite Curve {1} = N + 1;

Physical Point("inlet") = {1};
Physical Point("outlet") = {2};
Physical Curve("gas") = {1};
