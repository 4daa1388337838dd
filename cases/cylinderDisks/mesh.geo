// The front of a cylinder of radius R diameters across a stream along x, upper half: triangles of side R/N near the body, twice that at
// the inlet: gmsh -setnumber N 20 ...
DefineConstant[ N = {12, Min 4, Name "cells per radius"} ];
R = 200;   front = 2.8*R;   top = 4.5*R;   h = R/N;

Point(1) = {0, 0, 0, h};
Point(2) = {-R, 0, 0, h};       Point(3) = {0, R, 0, h};
Point(4) = {0, top, 0, 2*h};    Point(5) = {-front, 0, 0, 2*h};

Circle(1) = {2, 1, 3};   Line(2) = {3, 4};   Ellipse(3) = {4, 1, 4, 5};   Line(4) = {5, 2};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Mesh.Algorithm = 6; // frontal Delaunay: triangles close to equilateral

Physical Curve("inlet") = {3};
Physical Curve("outlet") = {2};
Physical Curve("wall") = {1};
Physical Curve("symmetry") = {4};
Physical Surface("gas") = {1};
