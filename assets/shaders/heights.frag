// Blended by maximum: the highest top and, negated, the lowest underside over each point of a plane.
in float v_height;

layout(location = 0) out vec2 o_top_and_underside;

void main() { o_top_and_underside = vec2(v_height, -max(v_height, 0.0)); }
