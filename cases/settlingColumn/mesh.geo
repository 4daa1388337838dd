// 30 mm high (y) in N cells: a column.
DefineConstant[ N = {40, Min 8, Step 8, Name "cells along y"} ];
L = 0.03;

Point(1) = {0, 0, 0};
Point(2) = {0, L, 0};
Line(1) = {1, 2};
Transfinite Curve {1} = N + 1;
Physical Point("floor") = {1};
Physical Point("lid") = {2};
Physical Curve("gas") = {1};
