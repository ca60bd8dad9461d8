#version 460
#extension GL_GOOGLE_include_directive : require
// Lists the mass points within reach of the cutting balls at first contact, cleared ones left out.
#include "common.glsl"

void main() {
  Active mine = near_points[gl_WorkGroupID.x];
  uint i = mine.index * kGroupSize + gl_LocalInvocationID.x;
  bool live = i < frame.point_count && points[i].cleared == 0u;
  vec3 p = live ? vec3(points[i].x, points[i].y, points[i].z) : vec3(0.0);
  uvec2 reached = uvec2(0u);
  for (uvec2 rest = CuttingTools(mine); Any(rest); rest = WithoutLowest(rest)) {
    uint t = Lowest(rest);
    vec4 tool = frame.contact[t];
    float r = tool.w + frame.point_reach_mm + frame.built[t].w;
    vec3 away = tool.xyz - p;
    if (dot(away, away) < r * r) reached |= Bit(t);
  }
  if (!live || !Any(reached)) return;
  uint slot = atomicAdd(frame.live_point_count, 1u);
  if (slot % kGroupSize == 0u) atomicAdd(frame.live_points.x, 1u);
  live_points[slot] = Active(i, reached.x, reached.y);
}
