// A square less its lower right quarter, three blocks of N x N cells (or triangles: T = 1).
DefineConstant[ N = 10, T = 0 ];
Point(1) = {0, 0, 0};     Point(2) = {0.5, 0, 0};   Point(3) = {0.5, 0.5, 0}; Point(4) = {1, 0.5, 0};
Point(5) = {1, 1, 0};     Point(6) = {0.5, 1, 0};   Point(7) = {0, 1, 0};     Point(8) = {0, 0.5, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 8}; Line(4) = {8, 1}; Line(5) = {3, 4};
Line(6) = {4, 5}; Line(7) = {5, 6}; Line(8) = {6, 3}; Line(9) = {6, 7}; Line(10) = {7, 8};
Curve Loop(1) = {1, 2, 3, 4}; Curve Loop(2) = {5, 6, 7, 8}; Curve Loop(3) = {-3, -8, 9, 10};
Plane Surface(1) = {1}; Plane Surface(2) = {2}; Plane Surface(3) = {3};
Transfinite Curve {1:10} = N + 1;
If (T == 0)
  Transfinite Surface {1:3}; Recombine Surface {1:3};
EndIf
Physical Curve("inlet") = {4, 10}; Physical Curve("wallStep") = {2, 5}; Physical Curve("outlet") = {6};
Physical Curve("bottom") = {1}; Physical Curve("top") = {7, 9};
Physical Surface("gas") = {1:3};
