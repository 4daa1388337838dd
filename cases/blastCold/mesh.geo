// A quarter of the plane, L x L, in N x N cells; the blast begins in the corner.
DefineConstant[ N = {144, Min 8, Name "cells along an edge"} ];
L = 144;

Point(1) = {0, 0, 0};   Point(2) = {L, 0, 0};   Point(3) = {L, L, 0};   Point(4) = {0, L, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Transfinite Curve {1:4} = N + 1;
Transfinite Surface {1};
Recombine Surface {1};

Physical Curve("axes") = {1, 4};
Physical Curve("far") = {2, 3};
Physical Surface("gas") = {1};
