// A square of 10 cm without its lower right quarter (the step), N cells a side: gmsh -setnumber N 100 ...
DefineConstant[ N = {100, Min 8, Step 2, Name "cells per side (even)"} ];
L = 10;

Point(1) = {0, 0, 0};     Point(2) = {L/2, 0, 0};
Point(3) = {0, L/2, 0};   Point(4) = {L/2, L/2, 0};   Point(5) = {L, L/2, 0};
Point(6) = {0, L, 0};     Point(7) = {L/2, L, 0};     Point(8) = {L, L, 0};

Line(1) = {1, 2};   Line(2) = {2, 4};    Line(3) = {4, 3};    Line(4) = {3, 1};
Line(5) = {4, 7};   Line(6) = {7, 6};    Line(7) = {6, 3};
Line(8) = {4, 5};   Line(9) = {5, 8};    Line(10) = {8, 7};

Curve Loop(1) = {1, 2, 3, 4};       Plane Surface(1) = {1};
Curve Loop(2) = {-3, 5, 6, 7};      Plane Surface(2) = {2};
Curve Loop(3) = {8, 9, 10, -5};     Plane Surface(3) = {3};
Transfinite Curve {1:10} = N/2 + 1;
Transfinite Surface {1:3};
Recombine Surface {1:3};

Physical Curve("inlet") = {4, 7, 6, 10};
Physical Curve("outlet") = {9, 1};
Physical Curve("wall") = {2, 8};
Physical Surface("gas") = {1:3};
