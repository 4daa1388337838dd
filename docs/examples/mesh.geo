// A box of 0.08 m x 0.04 m in 40 x 20 cells, for the three examples.
L = 0.08; H = 0.04;
Point(1) = {0, 0, 0}; Point(2) = {L, 0, 0}; Point(3) = {L, H, 0}; Point(4) = {0, H, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Transfinite Curve {1, 3} = 41; Transfinite Curve {2, 4} = 21; Transfinite Surface {1}; Recombine Surface {1};
Physical Curve("floor") = {1}; Physical Curve("right") = {2}; Physical Curve("lid") = {3}; Physical Curve("left") = {4};
Physical Surface("cells") = {1};
