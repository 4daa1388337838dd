// A bed W wide, cyclic along x, in a box H high, in cells of W/2 x 2.
DefineConstant[ W = {20, Min 12, Step 2, Name "width in small diameters"} ];
H = 40;

Point(1) = {0, 0, 0};   Point(2) = {W, 0, 0};   Point(3) = {W, H, 0};   Point(4) = {0, H, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Transfinite Curve {1, 3} = 3;
Transfinite Curve {2, 4} = H/2 + 1;
Transfinite Surface {1};
Recombine Surface {1};

Physical Curve("floor") = {1};
Physical Curve("right") = {2};
Physical Curve("lid") = {3};
Physical Curve("left") = {4};
Physical Surface("grains") = {1};
