// Half a section of a pipe of radius 10 grain diameters in N square cells, four of them along it: gmsh -setnumber N 20 ...
DefineConstant[ N = {24, Min 8, Name "cells across"} ];
L = 4*10/N;

Point(1) = {0, 0, 0};   Point(2) = {L, 0, 0};   Point(3) = {L, 10, 0};   Point(4) = {0, 10, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Transfinite Curve {1, 3} = 5;
Transfinite Curve {2, 4} = N + 1;
Transfinite Surface {1};
Recombine Surface {1};

Physical Curve("axis") = {1};
Physical Curve("right") = {2};
Physical Curve("wall") = {3};
Physical Curve("left") = {4};
Physical Surface("gas") = {1};
