// Hexahedra and prisms side by side (M = 0), tetrahedra (M = 1), hexahedra under pyramids and tetrahedra (M = 2).
DefineConstant[ M = 0 ];
Point(1) = {0, 0, 0, 0.3}; Point(2) = {1, 0, 0, 0.3}; Point(3) = {1, 1, 0, 0.3}; Point(4) = {0, 1, 0, 0.3};
Point(5) = {2, 0, 0, 0.3}; Point(6) = {2, 1, 0, 0.3};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1}; Line(5) = {2, 5}; Line(6) = {5, 6}; Line(7) = {6, 3};
Curve Loop(1) = {1, 2, 3, 4}; Curve Loop(2) = {5, 6, 7, -2};
Plane Surface(1) = {1}; Plane Surface(2) = {2};
If (M != 1)
  Transfinite Curve {1:7} = 4; Transfinite Surface {1}; Recombine Surface {1};
EndIf
If (M == 0)
  a[] = Extrude {0, 0, 1} { Surface{1}; Layers{3}; Recombine; };
  b[] = Extrude {0, 0, 1} { Surface{2}; Layers{3}; Recombine; };
EndIf
If (M == 1)
  a[] = Extrude {0, 0, 1} { Surface{1}; };
  b[] = Extrude {0, 0, 1} { Surface{2}; };
EndIf
If (M == 2)
  Point(11) = {0.5, 0.5, 1, 0.3};
  Line(11) = {1, 11}; Line(12) = {2, 11}; Line(13) = {3, 11}; Line(14) = {4, 11};
  Curve Loop(11) = {1, 12, -11}; Curve Loop(12) = {2, 13, -12}; Curve Loop(13) = {3, 14, -13}; Curve Loop(14) = {4, 11, -14};
  Plane Surface(11) = {11}; Plane Surface(12) = {12}; Plane Surface(13) = {13}; Plane Surface(14) = {14};
  Surface Loop(1) = {1, 11, 12, 13, 14};
  Volume(1) = {1};
  a[] = Extrude {0, 0, -1} { Surface{1}; Layers{3}; Recombine; };
  Physical Volume("gas") = {1, a[1]};
  Physical Surface("bottom") = {a[0]}; Physical Surface("top") = {11:14};
  Physical Surface("wallSides") = {a[2], a[3], a[4], a[5]};
Else
  Physical Volume("gas") = {a[1], b[1]};
  Physical Surface("bottom") = {1, 2}; Physical Surface("top") = {a[0], b[0]};
  Physical Surface("wallSides") = {a[2], a[4], a[5], b[2], b[3], b[4]};
EndIf
