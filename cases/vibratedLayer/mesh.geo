// A column of 0.15 cm in N cells, the plate (wall) at x = 0.15: gmsh -setnumber N 750 ...
DefineConstant[ N = {1500, Min 8, Name "cells"} ];
L = 0.15;

Point(1) = {0, 0, 0};
Point(2) = {L, 0, 0};
Line(1) = {1, 2};
Transfinite Curve {1} = N + 1;

Physical Point("open") = {1};
Physical Point("wall") = {2};
Physical Curve("gas") = {1};
