// Half of a plate, A wide and D thick with its upper side at y = 0, below a jet; L wide, in N cells per two diameters. The axis is x = 0.
DefineConstant[ N = {1, Min 1, Max 4, Name "cells per two diameters"} ];
A = 24; D = 6; L = 96; B = 48; H = 336;

x[] = {0, A, L};
y[] = {-B, -D, 0, H};
For j In {0:3}
  For i In {0:2}
    Point(3*j + i + 1) = {x[i], y[j], 0};
  EndFor
  For i In {0:1}
    Line(10*j + i + 1) = {3*j + i + 1, 3*j + i + 2};
    Transfinite Curve {10*j + i + 1} = N*(x[i + 1] - x[i])/2 + 1;
  EndFor
EndFor
For j In {0:2}
  For i In {0:2}
    Line(100 + 10*j + i + 1) = {3*j + i + 1, 3*j + i + 4};
    Transfinite Curve {100 + 10*j + i + 1} = N*(y[j + 1] - y[j])/2 + 1;
  EndFor
EndFor
For j In {0:2}
  For i In {0:1}
    If (i != 0 || j != 1)
      Curve Loop(10*j + i + 1) = {10*j + i + 1, 100 + 10*j + i + 2, -(10*j + i + 11), -(100 + 10*j + i + 1)};
      Plane Surface(10*j + i + 1) = {10*j + i + 1};
      surfaces[] += {10*j + i + 1};
    EndIf
  EndFor
EndFor
Transfinite Surface {surfaces[]};
Recombine Surface {surfaces[]};
Physical Curve("axis") = {101, 121};
Physical Curve("plate") = {11, 21, 112};
Physical Curve("open") = {1, 2, 31, 32, 103, 113, 123};
Physical Surface("gas") = {surfaces[]};
