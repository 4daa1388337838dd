// A box of L x H grain diameters in cells of W x 1: gmsh -setnumber L 500 -setnumber H 100 ...
DefineConstant[ L = {300, Min 8, Step 2, Name "length"} ];
DefineConstant[ W = {2, Name "width of a cell"} ];
DefineConstant[ H = {60, Min 8, Name "height"} ];

Point(1) = {0, 0, 0};   Point(2) = {L, 0, 0};   Point(3) = {L, H, 0};   Point(4) = {0, H, 0};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
Transfinite Curve {1, 3} = L/W + 1;
Transfinite Curve {2, 4} = H + 1;
Transfinite Surface {1};
Recombine Surface {1};

Physical Curve("floor") = {1};
Physical Curve("right") = {2};
Physical Curve("lid") = {3};
Physical Curve("left") = {4};
Physical Surface("gas") = {1};
