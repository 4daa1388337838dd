// A periodic cube of L diameters in N cells along x and M along y and z: gmsh -setnumber L 26 ...
DefineConstant[ N = {32, Min 8, Name "cells along the wave"} ];
DefineConstant[ M = {4, Min 3, Name "cells across it"} ];
DefineConstant[ L = {31, Name "side in diameters"} ];

Point(1) = {0, 0, 0};   Point(2) = {L, 0, 0};   Point(3) = {L, L, 0};   Point(4) = {0, L, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Transfinite Curve {1, 3} = N + 1;
Transfinite Curve {2, 4} = M + 1;
Transfinite Surface {1};
Recombine Surface {1};
box[] = Extrude {0, 0, L} { Surface{1}; Layers{M}; Recombine; };

Physical Surface("back") = {1};
Physical Surface("front") = {box[0]};
Physical Surface("bottom") = {box[2]};
Physical Surface("right") = {box[3]};
Physical Surface("top") = {box[4]};
Physical Surface("left") = {box[5]};
Physical Volume("gas") = {box[1]};
