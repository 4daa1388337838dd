// The layer on a chute, 0.5 m long, 0.02 m deep: x down the slope, y away from the base. gmsh -setnumber N 50 ...
DefineConstant[ N = {100, Min 8, Name "cells across"} ];
L = 0.5;
H = 0.02;

Point(1) = {0, 0, 0};
Point(2) = {L, 0, 0};
Point(3) = {L, H, 0};
Point(4) = {0, H, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve {1, 3} = 2 * N + 1;
Transfinite Curve {2, 4} = N + 1;
Transfinite Surface {1};
Recombine Surface {1};

Physical Curve("base") = {1};
Physical Curve("outlet") = {2};
Physical Curve("surface") = {3};
Physical Curve("inlet") = {4};
Physical Surface("mixture") = {1};
