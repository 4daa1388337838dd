// A column, L0 = 100 mm wide and A times as high, at the left end of a floor that it runs out on. N cells across the column.
DefineConstant[ N = {24, Min 6, Step 2, Name "cells across the column"} ];
DefineConstant[ A = {1, Min 0.25, Name "height over width of the column"} ];
DefineConstant[ round = {0, Choices{0, 1}, Name "a quarter of a round column, in 3D"} ];
L0 = 0.1;
// a box that the heap does not fill: run-outs are some 1.3 A below A = 2 and 2.2 A^(2/3) above
nx = Ceil((round ? 2.7 : A < 2 ? 2 + 2.2*A : 1.4 + 3*A^(2/3))*N);   ny = Ceil(1.15*A*N);
L = nx*L0/N;   H = ny*L0/N;

Point(1) = {0, 0, 0};   Point(2) = {L, 0, 0};   Point(3) = {L, H, 0};   Point(4) = {0, H, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Transfinite Curve {1, 3} = nx + 1;
Transfinite Curve {2, 4} = ny + 1;
Transfinite Surface {1};
Recombine Surface {1};

If (round)
  Extrude {0, 0, L} { Surface{1};  Layers{nx};  Recombine; } // surfaces 13, 17, 21 and 25 stand on curves 1 to 4, 26 is at z = L
  Physical Surface("floor") = {13};
  Physical Surface("sides") = {17, 25};
  Physical Surface("lid") = {21};
  Physical Surface("front") = {26};
  Physical Surface("back") = {1};
  Physical Volume("gas") = {1};
Else
  Physical Curve("floor") = {1};
  Physical Curve("sides") = {2, 4};
  Physical Curve("lid") = {3};
  Physical Surface("gas") = {1};
EndIf
