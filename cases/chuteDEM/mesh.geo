// A chute of 20 x 20 x 10 mm, cells of C. rough = 1: a chute of four ridges across it, of 26 mm by 6 mm: ridges 0.75 mm wide and 0.5 mm
// high, and grooves of 1.5 mm between them.
DefineConstant[ C = {1e-3, Min 5e-4, Step 5e-4, Name "cell"}, rough = {0, Choices{0, 1}, Name "rough floor"} ];
mm = 1e-3;

If (!rough)
  L = 20*mm;   H = 20*mm;   D = 10*mm;

  Point(1) = {0, 0, 0};   Point(2) = {L, 0, 0};   Point(3) = {L, H, 0};   Point(4) = {0, H, 0};
  Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};
  Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
  Transfinite Curve {1, 3} = Round(L/C) + 1;
  Transfinite Curve {2, 4} = Round(H/C) + 1;
  Transfinite Surface {1};
  Recombine Surface {1};
  piece[] = Extrude {0, 0, D} { Surface{1}; Layers{Round(D/C)}; Recombine; };

  back[] = {1};   front[] = {piece[0]};   floor[] = {piece[2]};   right[] = {piece[3]};   top[] = {piece[4]};   left[] = {piece[5]};
  volume[] = {piece[1]};
Else
  N = 4;   H = 26;   D = 6;   R = 0.5;   S = 2*N + 1; // strips along x: grooves, the first and the last half as wide, are even, ridges odd
  For i In {0:S}
    x = (i == 0) ? 0 : (i == S) ? 2.25*N : 1.125*(i - 1) + ((i % 2) ? 0.75 : 0.375);
    Point(3*i + 1) = {x*mm, -R*mm, 0};   Point(3*i + 2) = {x*mm, 0, 0};   Point(3*i + 3) = {x*mm, H*mm, 0};
    For k In {1:2}
      Line(5*i + k) = {3*i + k, 3*i + k + 1};
      Transfinite Curve {5*i + k} = Round(((k == 2) ? H : R)*3/R) + 1;
    EndFor
  EndFor
  For i In {0:S - 1}
    For k In {1:3}
      Line(5*i + 2 + k) = {3*i + k, 3*i + 3 + k};
      Transfinite Curve {5*i + 2 + k} = (i % 2 || i == 0 || i == S - 1) ? 4 : 7;
    EndFor
    For k In {1:2}
      Curve Loop(2*i + k) = {5*i + 2 + k, 5*i + 5 + k, -(5*i + 3 + k), -(5*i + k)};
      Plane Surface(2*i + k) = {2*i + k};
      Transfinite Surface {2*i + k};   Recombine Surface {2*i + k};
    EndFor
  EndFor
  // the sides of a piece stand in the order of its curve loop: below, right, above, left
  For i In {0:S - 1}
    For k In {1:2}
      If (k == 2 || i % 2 == 0)
        piece[] = Extrude {0, 0, D*mm} { Surface{2*i + k}; Layers{4}; Recombine; };
        back[] += 2*i + k;   front[] += piece[0];   volume[] += piece[1];
        If (k == 1 || i % 2)
          floor[] += piece[2];
        EndIf
        If (k == 2)
          top[] += piece[4];
        EndIf
        If (i == 0)
          left[] += piece[5];
        ElseIf (k == 1)
          floor[] += piece[5];
        EndIf
        If (i == S - 1)
          right[] += piece[3];
        ElseIf (k == 1)
          floor[] += piece[3];
        EndIf
      EndIf
    EndFor
  EndFor
EndIf
Physical Surface("back") = {back[]};
Physical Surface("front") = {front[]};
Physical Surface("floor") = {floor[]};
Physical Surface("right") = {right[]};
Physical Surface("lid") = {top[]};
Physical Surface("left") = {left[]};
Physical Volume("grains") = {volume[]};
