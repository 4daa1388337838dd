// A wedge of 15 degrees, 150 diameters long (along x), in a stream along x that begins A diameters ahead of it: triangles of side 150/N.
DefineConstant[ N = {50, Min 5, Name "cells along the wedge"} ];
DefineConstant[ A = {20, Min 5, Name "length of the stream ahead"} ];
L = 150;   top = 130;   rise = L*Tan(15*Pi/180);   h = L/N;

Point(1) = {-A, 0, 0, h};    Point(2) = {0, 0, 0, h};      Point(3) = {L, rise, 0, h};
Point(4) = {L, top, 0, h};   Point(5) = {-A, top, 0, h};

Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 5};   Line(5) = {5, 1};
Curve Loop(1) = {1:5};   Plane Surface(1) = {1};
Mesh.Algorithm = 6; // frontal Delaunay: triangles close to equilateral

Physical Curve("inlet") = {5};
Physical Curve("outlet") = {3, 4};
Physical Curve("floor") = {1};
Physical Curve("wedge") = {2};
Physical Surface("gas") = {1};
