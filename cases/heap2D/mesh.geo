// A box of 32 x 24 mm: N cells along x, 3 N/4 along y.
DefineConstant[ N = {64, Min 16, Step 16, Name "cells along x"} ];
L = 0.032; H = 0.024;

Point(1) = {0, 0, 0};   Point(2) = {L, 0, 0};   Point(3) = {L, H, 0};   Point(4) = {0, H, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Transfinite Curve {1, 3} = N + 1;
Transfinite Curve {2, 4} = 3*N/4 + 1;
Transfinite Surface {1};
Recombine Surface {1};

Physical Curve("floor") = {1};
Physical Curve("sides") = {2, 4};
Physical Curve("lid") = {3};
Physical Surface("gas") = {1};
