#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 3, first half, one workgroup: the rate law (twin of simulation::AdvanceOfFrame and EndOfAdvance).
#include "common.glsl"

layout(constant_id = 1) const uint kPointClusters = 1;

shared float engaged[kEngagedColumns];

void main() {
  uint lane = gl_LocalInvocationID.x;
  if (lane < kEngagedColumns) {
    float sum = 0.0;
    for (uint w = 0; w < kPointClusters; ++w)
      if (engaged_sums[w * kEngagedStride] > 0.0) sum += engaged_sums[w * kEngagedStride + 1 + lane];
    engaged[lane] = sum;
    frame.engaged[lane] = sum;
  }
  barrier();
  if (lane != 0) return;

  float x = frame.delta.w, advance = 0.0, edge_work = 0.0;
  if (x > 0.0 && frame.spindle_rad_per_s != 0.0 && frame.dt_s > 0.0) {
    float area = 0.0, moment = 0.0, work_per_mm = 0.0;
    for (uint m = 0; m < frame.material_count; ++m) {
      area += engaged[2 * m];
      moment += frame.material[m].y * engaged[2 * m + 1];
      work_per_mm += frame.material[m].x * engaged[2 * m];
    }
    float arm = area > 0.0 ? moment / area : 0.0;
    float force = min(frame.stiffness_N_per_mm * x, frame.max_force_N);
    float work = force * abs(frame.spindle_rad_per_s) * arm * frame.dt_s;
    if (frame.immediate != 0u) {
      advance = x;
      edge_work = work;
    } else if (work_per_mm <= 0.0) {
      advance = min(x, frame.layer_mm);
    } else {
      float linear = max(0.0, work - frame.work_held_back_Nmm) / work_per_mm;
      float y = linear / x;
      // x (1 - exp(-y)); the series where the difference would cancel
      advance = x * (y < 1e-2 ? y * (1.0 - y * (0.5 - y / 6.0)) : 1.0 - exp(-y));
      edge_work = linear > 0.0 ? work * advance / linear : work;
    }
  }
  frame.advance_mm = advance;
  frame.edge_work_Nmm = edge_work;

  vec3 slid = AtSlid(frame.tool_count);
  vec3 step_mm = -advance * frame.n.xyz;
  if (frame.plane_point[kShaft].w > 0.0) {
    vec3 n = frame.plane_n[kShaft].xyz;
    float gap = frame.plane_n[kShaft].w + dot(n, slid - frame.origin_contact.xyz);
    float closing = -dot(n, step_mm) - max(0.0, gap);
    if (closing > 0.0) step_mm += closing * n;
  }
  frame.origin_slid = vec4(slid, 0.0);
  frame.origin_end = vec4(slid + step_mm, 0.0);
}
