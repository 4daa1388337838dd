// A tube of 1 m in N cells, the wall at x = 10 as in ../wall: gmsh -setnumber N 1000 ...
DefineConstant[ N = {500, Min 8, Name "cells"} ];
L = 100;

Point(1) = {10 - L, 0, 0};
Point(2) = {10, 0, 0};
Line(1) = {1, 2};
Transfinite Curve {1} = N + 1;

Physical Point("inlet") = {1};
Physical Point("wall") = {2};
Physical Curve("gas") = {1};
