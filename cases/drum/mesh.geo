// A round drum, R = 30 mm, of triangles with N edges in a radius.
DefineConstant[ N = {12, Min 4, Step 1, Name "edges in a radius"} ];
R = 0.03;

Point(1) = {0, 0, 0};
For q In {0:3}
  Point(2 + q) = {R*Cos(q*Pi/2), R*Sin(q*Pi/2), 0};
EndFor
For q In {0:3}
  Circle(1 + q) = {2 + q, 1, 2 + (q + 1)%4};
EndFor
Curve Loop(1) = {1:4};   Plane Surface(1) = {1};
MeshSize {:} = R/N;

Physical Curve("drum") = {1:4};
Physical Surface("gas") = {1};
