// A periodic square of L small diameters in N x N cells.
DefineConstant[ L = {60, Min 8, Name "side in diameters"} ];
DefineConstant[ N = {6, Min 3, Name "cells per side"} ];

Point(1) = {0, 0, 0};   Point(2) = {L, 0, 0};   Point(3) = {L, L, 0};   Point(4) = {0, L, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Transfinite Curve {1:4} = N + 1;
Transfinite Surface {1};
Recombine Surface {1};

Physical Curve("bottom") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
Physical Curve("left") = {4};
Physical Surface("grains") = {1};
