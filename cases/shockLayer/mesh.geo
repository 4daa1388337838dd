// A box of W x H x W grain diameters on a shaken plate, in 4 x N x 4 cells; periodic along x and z.
DefineConstant[ N = {120, Min 20, Name "cells along the height"} ];
W = 16; H = 60;

Point(1) = {0, 0, 0};   Point(2) = {W, 0, 0};   Point(3) = {W, H, 0};   Point(4) = {0, H, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Transfinite Curve {1, 3} = 5;
Transfinite Curve {2, 4} = N + 1;
Transfinite Surface {1};
Recombine Surface {1};
box[] = Extrude {0, 0, W} { Surface{1}; Layers{4}; Recombine; };

Physical Surface("back") = {1};
Physical Surface("front") = {box[0]};
Physical Surface("floor") = {box[2]};
Physical Surface("right") = {box[3]};
Physical Surface("lid") = {box[4]};
Physical Surface("left") = {box[5]};
Physical Volume("gas") = {box[1]};
