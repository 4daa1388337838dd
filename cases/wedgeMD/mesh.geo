// The square of cases/wedge, 10 cm without its lower right quarter (the step), N cells a side, with A cm more of the stream ahead of it. D > 0: as
// deep as D, one cell, for grains.
DefineConstant[ N = {160, Min 16, Step 8, Name "cells per 10 cm (a multiple of 8)"} ];
DefineConstant[ A = {0, Min 0, Name "more of the stream (cm), as long as whole cells"} ];
DefineConstant[ D = {0, Min 0, Name "depth (cm); 0: plane"} ];
L = 10;   H = L/2;

Point(1) = {-A, 0, 0};    Point(2) = {H, 0, 0};
Point(3) = {-A, H, 0};    Point(4) = {H, H, 0};     Point(5) = {L, H, 0};
Point(6) = {-A, L + A, 0};   Point(7) = {H, L + A, 0};   Point(8) = {L, L + A, 0};

Line(1) = {1, 2};   Line(2) = {2, 4};    Line(3) = {4, 3};    Line(4) = {3, 1};
Line(5) = {4, 7};   Line(6) = {7, 6};    Line(7) = {6, 3};
Line(8) = {4, 5};   Line(9) = {5, 8};    Line(10) = {8, 7};

Curve Loop(1) = {1, 2, 3, 4};       Plane Surface(1) = {1};
Curve Loop(2) = {-3, 5, 6, 7};      Plane Surface(2) = {2};
Curve Loop(3) = {8, 9, 10, -5};     Plane Surface(3) = {3};
Transfinite Curve {2, 4, 8, 10} = N/2 + 1;
Transfinite Curve {1, 3, 5, 6, 7, 9} = Round((H + A)*N/L) + 1;
Transfinite Surface {1:3};
Recombine Surface {1:3};

If (D > 0)
    b[] = Extrude {0, 0, D} { Surface{1:3}; Layers{1}; Recombine; };
    Physical Surface("back") = {1:3};
    Physical Surface("front") = {b[0], b[6], b[12]};
    Physical Surface("inlet") = {b[5], b[10], b[11], b[16]};
    Physical Surface("outlet") = {b[2], b[15]};
    Physical Surface("wall") = {b[3], b[14]};
    Physical Volume("gas") = {b[1], b[7], b[13]};
Else
    Physical Curve("inlet") = {4, 7, 6, 10};
    Physical Curve("outlet") = {9, 1};
    Physical Curve("wall") = {2, 8};
    Physical Surface("gas") = {1:3};
EndIf
