// A periodic cube of 100 grain diameters in N^3 cells: gmsh -setnumber N 128 ...
DefineConstant[ N = {48, Min 3, Name "cells per side"} ];
DefineConstant[ L = {100, Name "side in diameters"} ];

Point(1) = {0, 0, 0};   Point(2) = {L, 0, 0};   Point(3) = {L, L, 0};   Point(4) = {0, L, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Transfinite Curve {1:4} = N + 1;
Transfinite Surface {1};
Recombine Surface {1};
box[] = Extrude {0, 0, L} { Surface{1}; Layers{N}; Recombine; };

Physical Surface("back") = {1};
Physical Surface("front") = {box[0]};
Physical Surface("bottom") = {box[2]};
Physical Surface("right") = {box[3]};
Physical Surface("top") = {box[4]};
Physical Surface("left") = {box[5]};
Physical Volume("gas") = {box[1]};
