// A silo of 32 x 40 mm over a plate, 4 mm thick, with an orifice of 8 mm, and the room below, 12 mm high and open downwards. N cells across.
DefineConstant[ N = {32, Min 24, Step 8, Name "cells across (a multiple of 8)"} ];
// 1: free triangles whose sides are 0.75/N of the width
DefineConstant[ triangles = {0, Choices{0, 1}, Name "triangles"} ];
W = 0.016; D = 0.004; H = 0.04; P = 0.004; R = 0.016;

Point(1) = {-W, -R, 0};   Point(2) = {-D, -R, 0};   Point(3) = {D, -R, 0};   Point(4) = {W, -R, 0};
Point(5) = {-W, -P, 0};   Point(6) = {-D, -P, 0};   Point(7) = {D, -P, 0};   Point(8) = {W, -P, 0};
Point(9) = {-W, 0, 0};    Point(10) = {-D, 0, 0};   Point(11) = {D, 0, 0};   Point(12) = {W, 0, 0};
Point(13) = {-W, H, 0};   Point(14) = {-D, H, 0};   Point(15) = {D, H, 0};   Point(16) = {W, H, 0};

For row In {0:3}
  For column In {1:3}
    Line(10*row + column) = {4*row + column, 4*row + column + 1};
  EndFor
EndFor
For column In {1:4}
  Line(100 + column) = {column, column + 4};
  Line(120 + column) = {column + 8, column + 12};
EndFor
Line(112) = {6, 10};   Line(113) = {7, 11};

Curve Loop(1) = {1, 102, -11, -101};     Plane Surface(1) = {1};
Curve Loop(2) = {2, 103, -12, -102};     Plane Surface(2) = {2};
Curve Loop(3) = {3, 104, -13, -103};     Plane Surface(3) = {3};
Curve Loop(4) = {12, 113, -22, -112};    Plane Surface(4) = {4};
Curve Loop(5) = {21, 122, -31, -121};    Plane Surface(5) = {5};
Curve Loop(6) = {22, 123, -32, -122};    Plane Surface(6) = {6};
Curve Loop(7) = {23, 124, -33, -123};    Plane Surface(7) = {7};

If (triangles == 0)
  Transfinite Curve {1, 11, 21, 31, 3, 13, 23, 33} = 3*N/8 + 1;
  Transfinite Curve {2, 12, 22, 32} = N/4 + 1;
  Transfinite Curve {101:104} = 3*N/8 + 1;
  Transfinite Curve {112, 113} = N/8 + 1;
  Transfinite Curve {121:124} = 5*N/4 + 1;
  Transfinite Surface {1:7};
  Recombine Surface {1:7};
Else
  Mesh.MeshSizeMax = 0.75 * 2*W/N;
  Mesh.MeshSizeMin = 0.75 * 2*W/N;
EndIf

Physical Curve("outlet") = {1, 2, 3};
Physical Curve("wall") = {101, 104, 11, 13, 112, 113, 21, 23, 121, 124};
Physical Curve("lid") = {31, 32, 33};
Physical Surface("gas") = {1:7};
