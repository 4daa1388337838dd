// 36 mm across the layer (y) in N cells: a line. Along the floor (x) nothing varies.
DefineConstant[ N = {36, Min 18, Step 18, Name "cells along y"} ];
L = 0.036;

Point(1) = {0, 0, 0};
Point(2) = {0, L, 0};
Line(1) = {1, 2};
Transfinite Curve {1} = N + 1;
Physical Point("floor") = {1};
Physical Point("top") = {2};
Physical Curve("gas") = {1};
