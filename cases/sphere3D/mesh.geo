// The front of a sphere of radius R in a stream along x, an eighth of it about the axis (planes y = z and z = 0): tetrahedra of
// side R/N at the nose, two to four times that elsewhere: gmsh -setnumber N 16 ...
DefineConstant[ N = {22, Min 6, Name "cells per radius at the nose"} ];
R = 10;   front = 2*R;   top = 2.8*R;   h = R/N;
// The inlet is a part of a sphere about (a, 0, 0) through (-front, 0, 0) and (0, top, 0).
a = (top^2 - front^2)/(2*front);   c = Sqrt(0.5);

Point(1) = {0, 0, 0};   Point(2) = {a, 0, 0};
Point(3) = {-R, 0, 0, h};       Point(4) = {0, R, 0, 2*h};      Point(5) = {0, c*R, c*R, 2*h};
Point(6) = {-front, 0, 0, 2*h};   Point(7) = {0, top, 0, 4*h};      Point(8) = {0, c*top, c*top, 4*h};

Circle(1) = {3, 1, 4};   Circle(2) = {4, 1, 5};   Circle(3) = {5, 1, 3};
Circle(4) = {6, 2, 7};   Circle(5) = {7, 1, 8};   Circle(6) = {8, 2, 6};
Line(7) = {3, 6};   Line(8) = {4, 7};   Line(9) = {5, 8};

Curve Loop(1) = {1, 2, 3};       Surface(1) = {1} In Sphere {1};
Curve Loop(2) = {4, 5, 6};       Surface(2) = {2} In Sphere {2};
Curve Loop(3) = {1, 8, -4, -7};  Plane Surface(3) = {3};
Curve Loop(4) = {3, 7, -6, -9};  Plane Surface(4) = {4};
Curve Loop(5) = {2, 9, -5, -8};  Plane Surface(5) = {5};
Surface Loop(1) = {1:5};         Volume(1) = {1};
Mesh.OptimizeThreshold = 0.5; // flat tetrahedra cost time steps

Physical Surface("inlet") = {2};
Physical Surface("outlet") = {5};
Physical Surface("wall") = {1};
Physical Surface("symmetryBottom") = {3};
Physical Surface("symmetrySide") = {4};
Physical Volume("gas") = {1};
