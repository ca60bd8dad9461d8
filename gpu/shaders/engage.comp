#version 460
#extension GL_GOOGLE_include_directive : require
// Engaged area: volume of the mass points within a layer of the cutting surface over the layer's depth, projected on the
// plane normal to the force (twin of ReferenceEngine::MeasureEngagement).
#include "common.glsl"

void main() {
  uint slot = gl_GlobalInvocationID.x;
  if (slot >= frame.live_point_count) return;
  Active mine = live_points[slot];
  uint i = mine.index;
  if (frame.delta.w <= 0.0 || points[i].cleared != 0u) return;
  vec3 p = vec3(points[i].x, points[i].y, points[i].z);
  float nearest = frame.layer_mm, projection = 0.0;
  for (uvec2 rest = Tools(mine); Any(rest); rest = WithoutLowest(rest)) {
    uint t = Lowest(rest);
    vec4 tool = frame.contact[t];
    vec3 away = p - tool.xyz;
    float d = length(away), gap = d - tool.w;
    if (abs(gap) >= frame.layer_mm || gap >= nearest) continue;
    nearest = gap;
    projection = d > 0.0 ? max(0.0, -dot(frame.n.xyz, away) / d) : 0.0;
  }
  if (projection <= 0.0) return;
  float area = points[i].volume_mm3 / frame.layer_mm * projection;
  float arm = length(cross(p - frame.contact[frame.tool_count].xyz, frame.axis_z.xyz));
  uint m = points[i].material;
  for (bool pending = true; pending;) {
    uint same = subgroupBroadcastFirst(m);
    if (same != m) continue;
    ADD_TO(frame.engaged_sums[2 * same], area * frame.area_scale)
    ADD_TO(frame.engaged_sums[2 * same + 1], area * arm * frame.moment_scale)
    pending = false;
  }
}
