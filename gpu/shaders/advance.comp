#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 3, first half, one workgroup: the rate law (twin of simulation::AdvanceOfFrame and EndOfAdvance).
#include "common.glsl"

void main() {
  if (gl_LocalInvocationID.x != 0) return;
  float engaged[2 * kMaxMaterials];
  for (uint m = 0; m < kMaxMaterials; ++m) {
    engaged[2 * m] = Total(frame.engaged_sums[2 * m], frame.area_scale);
    engaged[2 * m + 1] = Total(frame.engaged_sums[2 * m + 1], frame.moment_scale);
    frame.engaged[2 * m] = engaged[2 * m];
    frame.engaged[2 * m + 1] = engaged[2 * m + 1];
  }

  float x = frame.delta.w, advance = 0.0, edge_work = 0.0;
  if (x > 0.0 && frame.spindle_rad_per_s != 0.0 && frame.dt_s > 0.0) {
    float area = 0.0, moment = 0.0, work_per_mm = 0.0;
    for (uint m = 0; m < frame.material_count; ++m) {
      area += engaged[2 * m];
      moment += frame.material[m].y * engaged[2 * m + 1];
      work_per_mm += frame.material[m].x * engaged[2 * m];
    }
    float most = max(0.0, frame.max_slide_mm - SlideFraction() * frame.way_mm);
    float arm = area > 0.0 ? moment / area : 0.0;
    float force = min(frame.stiffness_N_per_mm * x, frame.max_force_N);
    float work = force * abs(frame.spindle_rad_per_s) * arm * frame.dt_s;
    if (frame.immediate != 0u) {
      advance = x;
      edge_work = work;
    } else if (work_per_mm <= 0.0) {
      advance = min(x, most);
    } else {
      float linear = max(0.0, work - frame.work_held_back_Nmm) / work_per_mm;
      float y = linear / x;
      // x (1 - exp(-y)); the series where the difference would cancel
      advance = min(x * (y < 1e-2 ? y * (1.0 - y * (0.5 - y / 6.0)) : 1.0 - exp(-y)), most);
      edge_work = linear > 0.0 ? work * advance / linear : work;
    }
  }
  frame.advance_mm = advance;
  frame.edge_work_Nmm = edge_work;

  uint origin = frame.tool_count;
  vec3 slide_mm = SlideFraction() * (frame.target[origin].xyz - frame.contact[origin].xyz);
  vec3 step_mm = -advance * frame.n.xyz;
  if (frame.plane_point[kShaft].w > 0.0) {
    vec3 n = frame.plane_n[kShaft].xyz;
    float gap = frame.plane_n[kShaft].w + dot(n, slide_mm);
    float closing = -dot(n, step_mm) - max(0.0, gap);
    if (closing > 0.0) step_mm += closing * n;
  }
  for (uint t = 0; t <= frame.tool_count; ++t) {
    vec4 slid = vec4(mix(frame.contact[t].xyz, frame.target[t].xyz, SlideFraction()), frame.contact[t].w);
    frame.slid[t] = slid;
    frame.end[t] = vec4(slid.xyz + step_mm, slid.w);
  }
}
