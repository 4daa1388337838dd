// Half of a round column of the radius R0 = 100 mm, A times as high as that: x is the radius, y the axis. N cells in R0.
DefineConstant[ N = {24, Min 6, Step 2, Name "cells in the radius of the column"} ];
DefineConstant[ A = {1, Min 0.25, Name "height over radius of the column"} ];
R0 = 0.1;
// a box that the heap does not fill: run-outs are 1.24 A below A = 1.7 and 1.6 Sqrt(A) above
nx = Ceil((A < 1.7 ? 1.6 + 1.8*A : 1.6 + 2.2*Sqrt(A))*N);   ny = Ceil(1.15*A*N);
L = nx*R0/N;   H = ny*R0/N;

Point(1) = {0, 0, 0};   Point(2) = {L, 0, 0};   Point(3) = {L, H, 0};   Point(4) = {0, H, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Transfinite Curve {1, 3} = nx + 1;
Transfinite Curve {2, 4} = ny + 1;
Transfinite Surface {1};
Recombine Surface {1};

Physical Curve("floor") = {1};
Physical Curve("side") = {2};
Physical Curve("lid") = {3};
Physical Curve("middle") = {4};
Physical Surface("gas") = {1};
