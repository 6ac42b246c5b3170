// Lights that belong to models (KHR_lights_punctual).
const int kMostLamps = 8;
uniform int u_lamp_count;
uniform vec4 u_lamp_position[kMostLamps];   // w 1: a place, 0: xyz is the direction towards the light
uniform vec4 u_lamp_intensity[kMostLamps];  // rgb / pi; a: range, 0 unlimited
uniform vec4 u_lamp_axis[kMostLamps];       // direction it shines; w: cosine of the outer cone
uniform vec4 u_lamp_inner[kMostLamps];      // x: cosine of the inner cone

// Irradiance / pi that a facing surface gets.
vec3 lamp_light(int i, vec3 at, out vec3 to_lamp) {
  vec4 position = u_lamp_position[i];
  to_lamp = position.xyz - position.w * at;
  float distance2 = max(dot(to_lamp, to_lamp), 1e-8);
  to_lamp *= inversesqrt(distance2);
  vec3 light = u_lamp_intensity[i].rgb;
  if (position.w == 0.0) return light;
  float fall = 1.0 / distance2;
  float range = u_lamp_intensity[i].a;
  if (range > 0.0) {
    float share = distance2 / (range * range);
    fall *= clamp(1.0 - share * share, 0.0, 1.0);
  }
  float cosine = dot(u_lamp_axis[i].xyz, -to_lamp);
  float cone = clamp((cosine - u_lamp_axis[i].w) / max(u_lamp_inner[i].x - u_lamp_axis[i].w, 1e-4), 0.0, 1.0);
  return light * fall * cone * cone;
}
