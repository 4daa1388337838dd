// A box of 48 x 20 mm. N cells in a millimetre.
DefineConstant[ N = {1, Min 1, Step 1, Name "cells in a millimetre"} ];
W = 0.048; H = 0.02;

Point(1) = {0, 0, 0};   Point(2) = {W, 0, 0};   Point(3) = {W, H, 0};   Point(4) = {0, H, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Transfinite Curve {1, 3} = 48*N + 1;
Transfinite Curve {2, 4} = 20*N + 1;
Transfinite Surface {1};
Recombine Surface {1};

Physical Curve("floor") = {1};
Physical Curve("sides") = {2, 4};
Physical Curve("lid") = {3};
Physical Surface("gas") = {1};
