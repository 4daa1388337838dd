// A tunnel of 3 x 1 with a step of 0.2 at x = 0.6, N cells a height (a multiple of 5): gmsh -setnumber N 40 ...
DefineConstant[ N = {60, Min 15, Step 5, Name "cells per height"} ];

Point(1) = {0, 0, 0};     Point(2) = {0.6, 0, 0};
Point(3) = {0, 0.2, 0};   Point(4) = {0.6, 0.2, 0};   Point(5) = {3, 0.2, 0};
Point(6) = {0, 1, 0};     Point(7) = {0.6, 1, 0};     Point(8) = {3, 1, 0};

Line(1) = {1, 2};   Line(2) = {2, 4};    Line(3) = {4, 3};    Line(4) = {3, 1};
Line(5) = {4, 7};   Line(6) = {7, 6};    Line(7) = {6, 3};
Line(8) = {4, 5};   Line(9) = {5, 8};    Line(10) = {8, 7};

Curve Loop(1) = {1, 2, 3, 4};       Plane Surface(1) = {1};
Curve Loop(2) = {-3, 5, 6, 7};      Plane Surface(2) = {2};
Curve Loop(3) = {8, 9, 10, -5};     Plane Surface(3) = {3};
Transfinite Curve {1, 3, 6} = 3*N/5 + 1;
Transfinite Curve {2, 4} = N/5 + 1;
Transfinite Curve {5, 7, 9} = 4*N/5 + 1;
Transfinite Curve {8, 10} = 12*N/5 + 1;
Transfinite Surface {1:3};
Recombine Surface {1:3};

Physical Curve("inlet") = {4, 7};
Physical Curve("outlet") = {9};
Physical Curve("wall") = {1, 2, 8, 10, 6};
Physical Surface("gas") = {1:3};
