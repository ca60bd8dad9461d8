#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 1 again, from first contact to the constrained target (clusters of balls), and the engaged area (clusters of points).
#include "common.glsl"
#include "first_contact.glsl"
#include "tool_mask.glsl"

layout(constant_id = 0) const uint kBallClusters = 1;

shared uint first;
shared float area[64];
shared float moment[64];
shared uint material[64];
shared uint any;

void Slide() {
  uint i = gl_GlobalInvocationID.x;
  if (gl_LocalInvocationID.x == 0) first = floatBitsToUint(2.0);
  if (!MaskTool(ball_clusters[gl_WorkGroupID.x], 1, 0.0, false)) return;
  if (i < frame.ball_count && balls[i].w > 0.0) {
    vec4 ball = balls[i];
    float s = 2.0;
    for (uint t = 0; t < frame.tool_count; ++t) {
      if (!InMask(t)) continue;
      vec3 a = AtContact(t);
      s = min(s, FirstContactFraction(ball.xyz - a, AtTarget(t) - a, frame.start[t].w + ball.w - frame.tolerance_mm));
    }
    if (s < 2.0) atomicMin(first, floatBitsToUint(s));
  }
  barrier();
  if (gl_LocalInvocationID.x == 0 && first < floatBitsToUint(2.0)) atomicMin(frame.slide_bits, first);
}

void Engage() {
  uint lane = gl_LocalInvocationID.x;
  uint cluster = gl_WorkGroupID.x - kBallClusters;
  uint i = cluster * kGroupSize + lane;
  uint base = cluster * kEngagedStride;
  if (lane == 0) any = 0;
  bool reached = frame.delta.w > 0.0 && MaskTool(point_clusters[cluster], 2, frame.layer_mm, true);
  barrier();
  float a = 0.0, arm = 0.0;
  uint m = 0;
  if (reached && i < frame.point_count && points[i].cleared == 0u) {
    vec3 p = vec3(points[i].x, points[i].y, points[i].z);
    m = points[i].material;
    float nearest = frame.layer_mm, projection = 0.0;
    for (uint t = 0; t < frame.tool_count; ++t) {
      if (!InMask(t)) continue;
      vec3 away = p - AtContact(t);
      float d = length(away), gap = d - frame.start[t].w;
      if (abs(gap) >= frame.layer_mm || gap >= nearest) continue;
      nearest = gap;
      projection = d > 0.0 ? max(0.0, -dot(frame.n.xyz, away) / d) : 0.0;
    }
    a = points[i].volume_mm3 / frame.layer_mm * projection;
    arm = length(cross(p - AtContact(frame.tool_count), frame.axis_z.xyz));
  }
  area[lane] = a;
  moment[lane] = a * arm;
  material[lane] = m;
  if (a > 0.0) atomicOr(any, 1u);
  barrier();
  if (lane == 0) engaged_sums[base] = float(any);
  if (any == 0u || lane >= kEngagedColumns) return;
  uint wanted = lane >> 1;
  float sum = 0.0;
  for (uint r = 0; r < 64; ++r)
    if (material[r] == wanted) sum += (lane & 1u) == 0u ? area[r] : moment[r];
  engaged_sums[base + 1 + lane] = sum;
}

void main() {
  if (gl_WorkGroupID.x < kBallClusters) Slide();
  else Engage();
}
