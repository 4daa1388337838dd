// The section of a channel, 48 mm wide (x) and 80 mm high (y): N x 2 N cells. Gas flows along z, which the mesh does not resolve.
DefineConstant[ N = {40, Min 10, Step 10, Name "cells across"} ];
DefineConstant[ shape = {0, Choices{0 = "section", 1 = "column", 2 = "box of three cells along z", 3 = "channel of 2.26 m in 80 cells along z"}, Name "shape"} ];
W = 0.048; H = 0.08;

If (shape == 1)
  Point(1) = {0, 0, 0};
  Point(2) = {0, H, 0};
  Line(1) = {1, 2};
  Transfinite Curve {1} = 2*N + 1;
  Physical Point("floor") = {1};
  Physical Point("lid") = {2};
  Physical Curve("gas") = {1};
Else
  Point(1) = {0, 0, 0};   Point(2) = {W, 0, 0};   Point(3) = {W, H, 0};   Point(4) = {0, H, 0};
  Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
  Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
  Transfinite Curve {1, 3} = N + 1;
  Transfinite Curve {2, 4} = 2*N + 1;
  Transfinite Surface {1};
  Recombine Surface {1};
  If (shape == 0)
    Physical Curve("floor") = {1};
    Physical Curve("right") = {2};
    Physical Curve("lid") = {3};
    Physical Curve("left") = {4};
    Physical Surface("gas") = {1};
  Else
    If (shape == 2)
      L = 3*W/N; cells = 3;
    Else
      L = 2.26; cells = 80;
    EndIf
    box[] = Extrude {0, 0, L} { Surface{1}; Layers{cells}; Recombine; };
    Physical Surface("back") = {1};
    Physical Surface("front") = {box[0]};
    Physical Surface("floor") = {box[2]};
    Physical Surface("right") = {box[3]};
    Physical Surface("lid") = {box[4]};
    Physical Surface("left") = {box[5]};
    Physical Volume("gas") = {box[1]};
  EndIf
EndIf
