// A box of 40 x 24 mm with an inlet, 3 mm wide, in the left corner of its top. N cells in a millimetre.
DefineConstant[ N = {1, Min 1, Step 1, Name "cells in a millimetre"} ];
W = 0.04; H = 0.024; D = 0.003;

Point(1) = {0, 0, 0};   Point(2) = {D, 0, 0};   Point(3) = {W, 0, 0};
Point(4) = {0, H, 0};   Point(5) = {D, H, 0};   Point(6) = {W, H, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {4, 5};   Line(4) = {5, 6};
Line(5) = {1, 4};   Line(6) = {2, 5};   Line(7) = {3, 6};
Curve Loop(1) = {1, 6, -3, -5};   Plane Surface(1) = {1};
Curve Loop(2) = {2, 7, -4, -6};   Plane Surface(2) = {2};
Transfinite Curve {1, 3} = 3*N + 1;
Transfinite Curve {2, 4} = 37*N + 1;
Transfinite Curve {5:7} = 24*N + 1;
Transfinite Surface {1:2};
Recombine Surface {1:2};

Physical Curve("floor") = {1, 2};
Physical Curve("sides") = {5, 7};
Physical Curve("inlet") = {3};
Physical Curve("lid") = {4};
Physical Surface("gas") = {1:2};
