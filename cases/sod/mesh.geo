// A tube of length 1 in N cells: gmsh -setnumber N 100 ...
DefineConstant[ N = {400, Min 8, Name "cells"} ];

Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0};
Line(1) = {1, 2};
Transfinite Curve {1} = N + 1;

Physical Point("left") = {1};
Physical Point("right") = {2};
Physical Curve("gas") = {1};
