// A quarter of the section of a can, x along its axis, y along the radius, N cells a side: gmsh -setnumber N 200 ...
DefineConstant[ N = {100, Min 8, Name "cells per side"} ];
L = 1;

Point(1) = {0, 0, 0};   Point(2) = {L, 0, 0};   Point(3) = {L, L, 0};   Point(4) = {0, L, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Transfinite Curve {1:4} = N + 1;
Transfinite Surface {1};
Recombine Surface {1};

Physical Curve("axis") = {1};
Physical Curve("end") = {2};
Physical Curve("side") = {3};
Physical Curve("middle") = {4};
Physical Surface("gas") = {1};
