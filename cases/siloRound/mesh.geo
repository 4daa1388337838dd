// Half of a round silo with an opening in its floor, over a room that is open downwards: x is the radius, y the axis.
// Lengths in grain diameters d; N cells a diameter.
DefineConstant[ N = {1, Min 1, Step 1, Name "cells in a diameter"} ];
DefineConstant[ D = {8, Min 4, Max 24, Step 2, Name "diameter of the opening"} ];
d = 0.001; W = 32; H = 30; P = 3; R = 12; // diameter and height of the silo, heights of floor and room below

x[] = {0, D/2*d, W/2*d};   y[] = {-(P + R)*d, -P*d, 0, H*d};
nx[] = {D/2*N, (W - D)/2*N};   ny[] = {R*N, P*N, H*N};
For j In {0:3}
  For i In {0:2}
    Point(3*j + i + 1) = {x[i], y[j], 0};
  EndFor
EndFor
For j In {0:3}
  For i In {0:1}
    Line(100 + 10*j + i) = {3*j + i + 1, 3*j + i + 2};   Transfinite Curve {100 + 10*j + i} = nx[i] + 1;
  EndFor
EndFor
For j In {0:2}
  For i In {0:2}
    If (j != 1 || i < 2)
      Line(200 + 10*j + i) = {3*j + i + 1, 3*j + i + 4};   Transfinite Curve {200 + 10*j + i} = ny[j] + 1;
    EndIf
  EndFor
EndFor
For j In {0:2}
  For i In {0:1}
    If (j != 1 || i == 0)
      Curve Loop(2*j + i + 1) = {100 + 10*j + i, 200 + 10*j + i + 1, -(110 + 10*j + i), -(200 + 10*j + i)};
      Plane Surface(2*j + i + 1) = {2*j + i + 1};
      Transfinite Surface {2*j + i + 1};   Recombine Surface {2*j + i + 1};
    EndIf
  EndFor
EndFor

Physical Curve("outlet") = {100, 101};
Physical Curve("wall") = {111, 121, 202, 211, 222};
Physical Curve("lid") = {130, 131};
Physical Curve("middle") = {200, 210, 220};
Physical Surface("gas") = {1, 2, 3, 5, 6};
