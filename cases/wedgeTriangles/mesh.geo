// A square of 10 cm without its lower right quarter (the step), triangles of side 10/N: gmsh -setnumber N 100 ...
DefineConstant[ N = {100, Min 8, Name "cells per side"} ];
L = 10;   h = L/N;

Point(1) = {0, 0, 0, h};   Point(2) = {L/2, 0, 0, h};   Point(3) = {L/2, L/2, 0, h};
Point(4) = {L, L/2, 0, h}; Point(5) = {L, L, 0, h};     Point(6) = {0, L, 0, h};

Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 5};   Line(5) = {5, 6};   Line(6) = {6, 1};
Curve Loop(1) = {1:6};   Plane Surface(1) = {1};
Mesh.Algorithm = 6; // frontal Delaunay: triangles close to equilateral

Physical Curve("inlet") = {5, 6};
Physical Curve("outlet") = {1, 4};
Physical Curve("wall") = {2, 3};
Physical Surface("gas") = {1};
