// 0.1 m high (y) in N cells: a column; with M > 0 the box of the paper with M cells along x and z (./Allrun box: 50).
DefineConstant[ N = {100, Min 10, Step 10, Name "cells along y"} ];
DefineConstant[ M = {0, Min 0, Step 10, Name "cells along x and z; 0: a column"} ];
L = 0.1;

If (M == 0)
  Point(1) = {0, 0, 0};
  Point(2) = {0, L, 0};
  Line(1) = {1, 2};
  Transfinite Curve {1} = N + 1;
  Physical Point("floor") = {1};
  Physical Point("lid") = {2};
  Physical Curve("gas") = {1};
Else
  Point(1) = {0, 0, 0};   Point(2) = {L, 0, 0};   Point(3) = {L, L, 0};   Point(4) = {0, L, 0};
  Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
  Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
  Transfinite Curve {1, 3} = M + 1;
  Transfinite Curve {2, 4} = N + 1;
  Transfinite Surface {1};
  Recombine Surface {1};
  box[] = Extrude {0, 0, L} { Surface{1}; Layers{M}; Recombine; };
  Physical Surface("back") = {1};
  Physical Surface("front") = {box[0]};
  Physical Surface("floor") = {box[2]};
  Physical Surface("right") = {box[3]};
  Physical Surface("lid") = {box[4]};
  Physical Surface("left") = {box[5]};
  Physical Volume("gas") = {box[1]};
EndIf
