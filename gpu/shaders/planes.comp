#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 2, first half: sums of the lens-weighted normals (equation 4, corrected) by group, a workgroup a cluster.
#include "common.glsl"
#include "tool_mask.glsl"

shared float rows[64 * 64];  // invocation × (group, column)
shared uint groups_seen;

const float kPi = 3.14159265358979;
const float kCapCosine = 0.766;

float LensVolume(float r1, float r2, float d) {
  if (d >= r1 + r2) return 0.0;
  float dr = r1 - r2;
  float least = min(r1, r2);
  if (d <= abs(dr)) return 4.0 / 3.0 * kPi * least * least * least;
  float over = r1 + r2 - d;
  return kPi * over * over * (d * d + 2.0 * d * (r1 + r2) - 3.0 * dr * dr) / (12.0 * d);
}

// Twin of simulation::PlaneGroup; u in G.
uint PlaneGroup(vec3 u) {
  if (-dot(u, frame.axis_z.xyz) > kCapCosine) return 0;
  float x = -dot(u, frame.axis_x.xyz), y = -dot(u, frame.axis_y.xyz);
  const float root3 = 1.7320508075688772;
  bool above = y >= 0.0, left_of_60 = y >= root3 * x, left_of_120 = y >= -root3 * x;
  if (above) return left_of_60 ? (left_of_120 ? 2 : 3) : 1;
  return left_of_120 ? 6 : (left_of_60 ? 4 : 5);
}

void main() {
  uint lane = gl_LocalInvocationID.x, i = gl_GlobalInvocationID.x;
  uint base = gl_WorkGroupID.x * kPlaneStride;
  bool reached = MaskTool(ball_clusters[gl_WorkGroupID.x], 2, frame.enlargement_mm, false);
  if (lane == 0) groups_seen = 0;
  barrier();
  vec4 ball = i < frame.ball_count ? balls[i] : vec4(0.0);
  bool cleared = false;
  if (reached && ball.w > 0.0) {
    for (uint t = 0; t < frame.tool_count; ++t) {
      if (!InMask(t)) continue;
      float r_t = frame.start[t].w;
      vec3 at = AtContact(t);
      vec3 from_bone = at - ball.xyz;
      float d = length(from_bone);
      float w = LensVolume(r_t + frame.enlargement_mm, ball.w, d);
      if (w <= 0.0 || d <= 0.0) continue;
      if (!cleared) {
        for (uint c = 0; c < 64; ++c) rows[lane * 64 + c] = (c % kPlaneColumns) == 7 ? kInfinity : 0.0;
        cleared = true;
      }
      vec3 u = from_bone / d;
      uint group = frame.goal[t].w > 0.5 ? PlaneGroup(u) : kShaft;
      atomicOr(groups_seen, 1u << group);
      uint row = lane * 64 + group * kPlaneColumns;
      vec3 point = at - r_t * u;
      rows[row + 0] += w;
      rows[row + 1] += w * u.x;
      rows[row + 2] += w * u.y;
      rows[row + 3] += w * u.z;
      rows[row + 4] += w * point.x;
      rows[row + 5] += w * point.y;
      rows[row + 6] += w * point.z;
      rows[row + 7] = min(rows[row + 7], d - r_t - ball.w);
    }
  }
  barrier();
  uint seen = groups_seen;
  if (lane == 0) plane_sums[base] = float(seen);
  if (seen == 0) return;
  if (!cleared) {
    for (uint c = 0; c < 64; ++c) rows[lane * 64 + c] = (c % kPlaneColumns) == 7 ? kInfinity : 0.0;
  }
  barrier();
  // each invocation adds up one column, in the order of the balls: the sum does not depend on scheduling
  if ((seen & (1u << (lane / kPlaneColumns))) == 0u) return;
  bool smallest = (lane % kPlaneColumns) == 7;
  float sum = smallest ? kInfinity : 0.0;
  for (uint r = 0; r < 64; ++r) sum = smallest ? min(sum, rows[r * 64 + lane]) : sum + rows[r * 64 + lane];
  plane_sums[base + 1 + lane] = sum;
}
