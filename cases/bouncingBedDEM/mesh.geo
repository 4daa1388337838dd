// 0.1 m high (y), W wide (x) and D deep (z), N cells along y, a fifth as fine along x, 2/5 along z: gmsh -setnumber W 0.02 ...
DefineConstant[ N = {100, Min 20, Step 20, Name "cells along y"} ];
DefineConstant[ W = {0.1, Min 0.02, Step 0.01, Name "width"} ];
L = 0.1;   D = 0.01;   M = Ceil(N*W/(5*L) - 1e-9);   K = 4;

Point(1) = {0, 0, 0};   Point(2) = {W, 0, 0};   Point(3) = {W, L, 0};   Point(4) = {0, L, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Transfinite Curve {1, 3} = M + 1;
Transfinite Curve {2, 4} = N + 1;
Transfinite Surface {1};
Recombine Surface {1};
box[] = Extrude {0, 0, D} { Surface{1}; Layers{K}; Recombine; };

Physical Surface("back") = {1};
Physical Surface("front") = {box[0]};
Physical Surface("floor") = {box[2]};
Physical Surface("right") = {box[3]};
Physical Surface("lid") = {box[4]};
Physical Surface("left") = {box[5]};
Physical Volume("grains") = {box[1]};
