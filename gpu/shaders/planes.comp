#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 2, first half: sums of the lens-weighted normals (equation 4, corrected) by group, over the balls within reach.
#include "common.glsl"

// Two pipelines of this source: the balls that cut, in seven groups, and those that do not, in one. The second is dispatched
// only where such a ball is near.
layout(constant_id = 2) const bool kShaftPass = false;
// Whether the mean touching point is summed; for a single cutting ball it follows from the normal.
layout(constant_id = 3) const bool kSumPoints = true;

const float kPi = 3.14159265358979;
const float kCapCosine = 0.766;
const float kLargestLens = 0.5;  // mm^3, simulation::kLargestLensVolume

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
  uint slot = gl_GlobalInvocationID.x;
  if (slot >= frame.live_ball_count) return;
  Active mine = live_balls[slot];
  uint i = mine.index;
  vec4 ball = balls[i];
  if (ball.w <= 0.0) return;
  vec3 origin = frame.contact[frame.tool_count].xyz;
  for (uvec2 rest = kShaftPass ? ShaftTools(mine) : CuttingTools(mine); Any(rest); rest = WithoutLowest(rest)) {
    uint t = Lowest(rest);
    vec4 tool = frame.contact[t];
    float r_t = tool.w;
    vec3 at = tool.xyz;
    vec3 from_bone = at - ball.xyz;
    float d = length(from_bone);
    float w = min(LensVolume(r_t + frame.enlargement_mm, ball.w, d), kLargestLens);
    if (w <= 0.0 || d <= 0.0) continue;
    vec3 u = from_bone / d;
    uint group = kShaftPass ? kShaft : PlaneGroup(u);
    vec3 point = at - r_t * u - origin;
    // neighbours in the list mostly touch the same group: one addition a group and subgroup
    for (bool pending = true; pending;) {
      uint same = subgroupBroadcastFirst(group);
      if (same != group) continue;
      uint row = same * kPlaneColumns;
      ADD_TO(frame.plane_sums[row + 0], w * kNormalScale)
      ADD_TO(frame.plane_sums[row + 1], w * u.x * kNormalScale)
      ADD_TO(frame.plane_sums[row + 2], w * u.y * kNormalScale)
      ADD_TO(frame.plane_sums[row + 3], w * u.z * kNormalScale)
      if (kSumPoints) {
        ADD_TO(frame.plane_sums[row + 4], w * point.x * frame.point_scale)
        ADD_TO(frame.plane_sums[row + 5], w * point.y * frame.point_scale)
        ADD_TO(frame.plane_sums[row + 6], w * point.z * frame.point_scale)
      }
      uint gap = subgroupMin(OrderedBits(d - r_t - ball.w));
      if (subgroupElect()) atomicMin(frame.plane_gap_bits[same], gap);
      pending = false;
    }
  }
}
