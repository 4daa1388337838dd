// A silo with a slot in its floor, over a room that is open downwards. Lengths in grain diameters d; N cells a diameter.
DefineConstant[ N = {1, Min 1, Step 1, Name "cells in a diameter"} ];
DefineConstant[ D = {8, Min 4, Max 24, Step 2, Name "width of the slot"} ];
d = 0.001; W = 32; H = 30; P = 3; R = 12; // widths of silo and slot, heights of silo, floor, room below

x[] = {-W/2*d, -D/2*d, D/2*d, W/2*d};   y[] = {-(P + R)*d, -P*d, 0, H*d};
nx[] = {(W - D)/2*N, D*N, (W - D)/2*N};   ny[] = {R*N, P*N, H*N};
For j In {0:3}
  For i In {0:3}
    Point(4*j + i + 1) = {x[i], y[j], 0};
  EndFor
EndFor
For j In {0:3}
  For i In {0:2}
    Line(100 + 10*j + i) = {4*j + i + 1, 4*j + i + 2};   Transfinite Curve {100 + 10*j + i} = nx[i] + 1;
  EndFor
EndFor
For j In {0:2}
  For i In {0:3}
    If (j != 1 || (i == 1 || i == 2))
      Line(200 + 10*j + i) = {4*j + i + 1, 4*j + i + 5};   Transfinite Curve {200 + 10*j + i} = ny[j] + 1;
    EndIf
  EndFor
EndFor
For j In {0:2}
  For i In {0:2}
    If (j != 1 || i == 1)
      Curve Loop(3*j + i + 1) = {100 + 10*j + i, 200 + 10*j + i + 1, -(110 + 10*j + i), -(200 + 10*j + i)};
      Plane Surface(3*j + i + 1) = {3*j + i + 1};
      Transfinite Surface {3*j + i + 1};   Recombine Surface {3*j + i + 1};
    EndIf
  EndFor
EndFor

Physical Curve("outlet") = {100, 101, 102};
Physical Curve("wall") = {110, 112, 120, 122, 200, 203, 211, 212, 220, 223};
Physical Curve("lid") = {130, 131, 132};
Physical Surface("gas") = {1, 2, 3, 5, 7, 8, 9};
