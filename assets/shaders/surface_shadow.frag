// Only faces turned to the sun cast: the walls of a room, seen from outside, let it in.
in float v_towards_light;

void main() {
  if (v_towards_light <= 0.0) discard;
}
