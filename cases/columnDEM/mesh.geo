// A box of 80 x 36 x 4 mm, cells of C; the column stands at its left wall.
DefineConstant[ C = {1e-3, Min 5e-4, Step 5e-4, Name "cell"} ];
L = 0.08;   H = 0.036;   D = 0.004;

Point(1) = {0, 0, 0};   Point(2) = {L, 0, 0};   Point(3) = {L, H, 0};   Point(4) = {0, H, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Transfinite Curve {1, 3} = Round(L/C) + 1;
Transfinite Curve {2, 4} = Round(H/C) + 1;
Transfinite Surface {1};
Recombine Surface {1};
box[] = Extrude {0, 0, D} { Surface{1}; Layers{Round(D/C)}; Recombine; };

Physical Surface("back") = {1};
Physical Surface("front") = {box[0]};
Physical Surface("floor") = {box[2]};
Physical Surface("right") = {box[3]};
Physical Surface("lid") = {box[4]};
Physical Surface("left") = {box[5]};
Physical Volume("grains") = {box[1]};
