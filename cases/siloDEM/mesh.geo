// A silo 20 mm wide and 40 mm high over a plate P thick with an orifice of W diameters, 4 mm deep, and the room below, 6 mm
// high and open downwards. Cells of C.
DefineConstant[ C = {5e-4, Min 5e-4, Step 5e-4, Name "cell"}, P = {0.002, Min 0.002, Step 1e-3, Name "thickness of the plate"},
                W = {6, Min 4, Step 2, Name "orifice in mm"} ];
B = 0.01;   O = W*5e-4;   H = 0.04;   R = P + 0.006;

Point(1) = {-B, -R, 0};   Point(2) = {-O, -R, 0};   Point(3) = {O, -R, 0};   Point(4) = {B, -R, 0};
Point(5) = {-B, -P, 0};   Point(6) = {-O, -P, 0};   Point(7) = {O, -P, 0};   Point(8) = {B, -P, 0};
Point(9) = {-B, 0, 0};    Point(10) = {-O, 0, 0};   Point(11) = {O, 0, 0};   Point(12) = {B, 0, 0};
Point(13) = {-B, H, 0};   Point(14) = {-O, H, 0};   Point(15) = {O, H, 0};   Point(16) = {B, H, 0};

For row In {0:3}
  For column In {1:3}
    Line(10*row + column) = {4*row + column, 4*row + column + 1};
  EndFor
EndFor
For column In {1:4}
  Line(100 + column) = {column, column + 4};
  Line(120 + column) = {column + 8, column + 12};
EndFor
Line(112) = {6, 10};   Line(113) = {7, 11};

Curve Loop(1) = {1, 102, -11, -101};     Plane Surface(1) = {1};
Curve Loop(2) = {2, 103, -12, -102};     Plane Surface(2) = {2};
Curve Loop(3) = {3, 104, -13, -103};     Plane Surface(3) = {3};
Curve Loop(4) = {12, 113, -22, -112};    Plane Surface(4) = {4};
Curve Loop(5) = {21, 122, -31, -121};    Plane Surface(5) = {5};
Curve Loop(6) = {22, 123, -32, -122};    Plane Surface(6) = {6};
Curve Loop(7) = {23, 124, -33, -123};    Plane Surface(7) = {7};

Transfinite Curve {1, 11, 21, 31, 3, 13, 23, 33} = Round((B - O)/C) + 1;
Transfinite Curve {2, 12, 22, 32} = Round(2*O/C) + 1;
Transfinite Curve {101:104} = Round((R - P)/C) + 1;
Transfinite Curve {112, 113} = Round(P/C) + 1;
Transfinite Curve {121:124} = Round(H/C) + 1;
Transfinite Surface {1:7};
Recombine Surface {1:7};

back[] = {1:7};
For i In {0:6}
  piece[] = Extrude {0, 0, 0.004} { Surface{back[i]}; Layers{Round(0.004/C)}; Recombine; };
  front[] += piece[0];
  volume[] += piece[1];
  // the sides of a piece stand in the order of its curve loop
  If (i < 3)
    outlet[] += piece[2];
  EndIf
  If (i == 0 || i == 2)
    plate[] += piece[4];
  EndIf
  If (i == 0 || i == 4)
    side[] += piece[5];
  EndIf
  If (i == 2 || i == 6)
    side[] += piece[3];
  EndIf
  If (i == 3)
    plate[] += {piece[3], piece[5]};
  EndIf
  If (i == 4 || i == 6)
    plate[] += piece[2];
  EndIf
  If (i > 3)
    lid[] += piece[4];
  EndIf
EndFor
Physical Surface("back") = {back[]};
Physical Surface("front") = {front[]};
Physical Surface("outlet") = {outlet[]};
Physical Surface("plate") = {plate[]};
Physical Surface("sides") = {side[]};
Physical Surface("lid") = {lid[]};
Physical Volume("grains") = {volume[]};
