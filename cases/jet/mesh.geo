// 30 mm along the axis (x) and 10 mm along the radius (y), N cells along the radius of the nozzle: gmsh -setnumber N 40 ...
DefineConstant[ N = {20, Min 4, Name "cells along the radius of the nozzle"} ];
R = 0.005;   L = 6*R;

Point(1) = {0, 0, 0};   Point(2) = {L, 0, 0};     Point(3) = {L, R, 0};
Point(4) = {0, R, 0};   Point(5) = {L, 2*R, 0};   Point(6) = {0, 2*R, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Line(5) = {3, 5};   Line(6) = {5, 6};   Line(7) = {6, 4};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Curve Loop(2) = {-3, 5, 6, 7};   Plane Surface(2) = {2};
Transfinite Curve {1, 3, 6} = 6*N + 1;
Transfinite Curve {2, 4, 5, 7} = N + 1;
Transfinite Surface {1, 2};
Recombine Surface {1, 2};

Physical Curve("axis") = {1};
Physical Curve("nozzle") = {4};
Physical Curve("rim") = {7};
Physical Curve("out") = {2, 5};
Physical Curve("free") = {6};
Physical Surface("gas") = {1, 2};
