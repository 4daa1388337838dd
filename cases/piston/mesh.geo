// A box of L x H diameters in N x M cells, periodic along y: gmsh -setnumber N 150 ...
DefineConstant[ N = {400, Min 30, Name "cells along the box"} ];
DefineConstant[ M = {4, Min 3, Name "cells across it"} ];
L = 400;
H = 120;

Point(1) = {0, 0, 0};   Point(2) = {L, 0, 0};   Point(3) = {L, H, 0};   Point(4) = {0, H, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Transfinite Curve {1, 3} = N + 1;
Transfinite Curve {2, 4} = M + 1;
Transfinite Surface {1};
Recombine Surface {1};

Physical Curve("bottom") = {1};
Physical Curve("stream") = {2};
Physical Curve("top") = {3};
Physical Curve("piston") = {4};
Physical Surface("gas") = {1};
