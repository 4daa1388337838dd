// The gap between two walls, 20 grain diameters in N cells: gmsh -setnumber N 20 ...
DefineConstant[ N = {80, Min 8, Name "cells"} ];

Point(1) = {0, 0, 0};
Point(2) = {20, 0, 0};
Line(1) = {1, 2};
Transfinite Curve {1} = N + 1;

Physical Point("left") = {1};
Physical Point("right") = {2};
Physical Curve("gas") = {1};
