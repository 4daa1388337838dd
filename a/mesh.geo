// A line of M cells from -L to L along y, the first and the last half as wide: their values stand on the walls, and the
// M values are those of M equally spaced nodes. gmsh -setnumber M 401 ...
DefineConstant[ M = {501, Min 5, Name "nodes"} ];
L = 0.5;
step = 2 * L / (M - 1);

Point(1) = {0, -L, 0};
Point(2) = {0, -L + step / 2, 0};
Point(3) = {0, L - step / 2, 0};
Point(4) = {0, L, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Transfinite Curve {1, 3} = 2;
Transfinite Curve {2} = M - 1;

Physical Point("bottom") = {1};
Physical Point("top") = {4};
Physical Curve("mixture") = {1, 2, 3};
