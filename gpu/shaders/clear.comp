#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 3, mass points: those inside a cutting ball's capsules are cleared, once, and booked in whole units of volume.
#include "common.glsl"

bool Inside(vec3 p, vec3 a, vec3 b, float r_t) { return distance(p, ClosestOnSegment(p, a, b)) < r_t; }

void main() {
  uint slot = gl_GlobalInvocationID.x;
  if (slot >= frame.live_point_count) return;
  Active mine = live_points[slot];
  uint i = mine.index;
  if (frame.spindle_rad_per_s == 0.0 || points[i].cleared != 0u) return;
  vec3 p = vec3(points[i].x, points[i].y, points[i].z);
  bool inside = false;
  for (uvec2 rest = Tools(mine); Any(rest); rest = WithoutLowest(rest)) {
    uint t = Lowest(rest);
    vec4 slid = frame.slid[t];
    inside = inside || Inside(p, frame.contact[t].xyz, slid.xyz, slid.w) || Inside(p, slid.xyz, frame.end[t].xyz, slid.w);
  }
  if (!inside) return;
  points[i].cleared = 1u;
  atomicAdd(point_clusters[i / kGroupSize].alive, 0xffffffffu);
  atomicAdd(frame.removed[points[i].material], points[i].units);
}
