// The section of a cone of 20 degrees and 10 cm length (along x) in a stream along x: triangles of side 10/N: gmsh -setnumber N 80 ...
DefineConstant[ N = {40, Min 5, Name "cells along the cone"} ];
L = 10;   ahead = 1;   top = 10;   rise = L*Tan(20*Pi/180);   h = L/N;

Point(1) = {-ahead, 0, 0, h};   Point(2) = {0, 0, 0, h};     Point(3) = {L, rise, 0, h};
Point(4) = {L, top, 0, h};      Point(5) = {-ahead, top, 0, h};

Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 5};   Line(5) = {5, 1};
Curve Loop(1) = {1:5};   Plane Surface(1) = {1};
Mesh.Algorithm = 6; // frontal Delaunay: triangles close to equilateral

Physical Curve("inlet") = {4, 5};
Physical Curve("outlet") = {3};
Physical Curve("axis") = {1};
Physical Curve("cone") = {2};
Physical Surface("gas") = {1};
