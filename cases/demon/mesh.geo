// Two compartments, each W wide and H high, in cells of 2/3 x 1; between them a wall, D thick, with a window from S to S + 4.
DefineConstant[ W = {20, Min 6, Step 2, Name "width of a compartment"} ];
H = 24; S = 8; D = 2;

x[] = {-W - D/2, -D/2, D/2, W + D/2};
y[] = {0, S, S + 4, H};
For j In {0:3}
  For i In {0:3}
    Point(4*j + i + 1) = {x[i], y[j], 0};
  EndFor
EndFor
For j In {0:3}
  For i In {0:2}
    Line(10*j + i + 1) = {4*j + i + 1, 4*j + i + 2};
  EndFor
EndFor
For j In {0:2}
  For i In {0:3}
    Line(100 + 10*j + i + 1) = {4*j + i + 1, 4*j + i + 5};
  EndFor
EndFor
For j In {0:2}
  For i In {0:2}
    If (i != 1 || j == 1)
      Curve Loop(10*j + i + 1) = {10*j + i + 1, 100 + 10*j + i + 2, -(10*j + i + 11), -(100 + 10*j + i + 1)};
      Plane Surface(10*j + i + 1) = {10*j + i + 1};
      surfaces[] += {10*j + i + 1};
    EndIf
  EndFor
EndFor
Transfinite Curve {1, 3, 11, 13, 21, 23, 31, 33} = 3*W/2 + 1;
Transfinite Curve {12, 22} = 4;
Transfinite Curve {101, 102, 103, 104} = S + 1;
Transfinite Curve {111, 112, 113, 114} = 5;
Transfinite Curve {121, 122, 123, 124} = H - S - 4 + 1;
Transfinite Surface {surfaces[]};
Recombine Surface {surfaces[]};
Physical Curve("floor") = {1, 3};
Physical Curve("lid") = {31, 33};
Physical Curve("sides") = {101, 104, 111, 114, 121, 124};
Physical Curve("divider") = {102, 103, 122, 123, 12, 22};
Physical Surface("gas") = {surfaces[]};
