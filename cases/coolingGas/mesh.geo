// A periodic square (D = 2, disks) or cube (D = 3, spheres) of side L with N cells a side:
// gmsh -setnumber D 3 -setnumber L 60 -setnumber N 4 ...
DefineConstant[
    D = {2, Min 2, Max 3, Name "dimensions"},
    L = {280, Name "side in diameters"},
    N = {28, Min 3, Name "cells per side"}
];

Point(1) = {0, 0, 0};   Point(2) = {L, 0, 0};   Point(3) = {L, L, 0};   Point(4) = {0, L, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Transfinite Curve {1:4} = N + 1;
Transfinite Surface {1};
Recombine Surface {1};

If (D == 2)
    Physical Curve("bottom") = {1};
    Physical Curve("right") = {2};
    Physical Curve("top") = {3};
    Physical Curve("left") = {4};
    Physical Surface("gas") = {1};
Else
    out[] = Extrude {0, 0, L} { Surface{1}; Layers{N}; Recombine; };
    Physical Surface("back") = {1};
    Physical Surface("front") = {out[0]};
    Physical Surface("bottom") = {out[2]};
    Physical Surface("right") = {out[3]};
    Physical Surface("top") = {out[4]};
    Physical Surface("left") = {out[5]};
    Physical Volume("gas") = {out[1]};
EndIf
