#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 3, second half: every cutting ball's capsules take their share of each bone ball (equation 5, corrected; twin of
// simulation::ShrinkBall), one invocation a ball; and of the mass points, one invocation a point.
#include "common.glsl"
#include "tool_mask.glsl"

layout(constant_id = 0) const uint kBallClusters = 1;

const float kLeastBallRadius = 1e-3;  // mm

void Shrink(inout vec4 ball, vec3 a, vec3 b, float r_t) {
  vec3 away = ball.xyz - ClosestOnSegment(ball.xyz, a, b);
  float d = length(away);
  float p = ball.w + r_t - d;
  if (ball.w <= 0.0 || p <= 0.0) return;
  if (p >= 2.0 * ball.w || ball.w - 0.5 * p < kLeastBallRadius) {
    ball.w = 0.0;
    return;
  }
  vec3 u;
  if (d > 0.0) {
    u = away / d;
  } else {
    vec3 m = b - a, s = abs(m);
    vec3 pick = s.x <= s.y && s.x <= s.z ? vec3(1, 0, 0) : s.y <= s.z ? vec3(0, 1, 0) : vec3(0, 0, 1);
    float mm = dot(m, m);
    u = normalize(mm > 0.0 ? pick - dot(pick, m) / mm * m : pick);
  }
  ball.xyz += 0.5 * p * u;
  ball.w -= 0.5 * p;
}

bool Inside(vec3 p, vec3 a, vec3 b, float r_t) {
  return distance(p, ClosestOnSegment(p, a, b)) < r_t;
}

void main() {
  if (frame.spindle_rad_per_s == 0.0) return;
  bool is_ball = gl_WorkGroupID.x < kBallClusters;
  uint cluster = is_ball ? gl_WorkGroupID.x : gl_WorkGroupID.x - kBallClusters;
  uint i = cluster * kGroupSize + gl_LocalInvocationID.x;
  // contact to end bounds the path from there over the slid proxy only together with the slide's length
  float bend = distance(AtSlid(frame.tool_count), frame.origin_contact.xyz);
  Cluster box;
  if (is_ball) box = ball_clusters[cluster];
  else box = point_clusters[cluster];
  if (!MaskTool(box, 3, bend, true)) return;

  if (is_ball) {
    if (i >= frame.ball_count) return;
    vec4 ball = balls[i];
    if (ball.w <= 0.0) return;
    float before = ball.w;
    for (uint part = 0; part < 2; ++part)
      for (uint t = 0; t < frame.tool_count; ++t) {
        if (!InMask(t)) continue;
        vec3 a = part == 0 ? AtContact(t) : AtSlid(t), b = part == 0 ? AtSlid(t) : AtEnd(t);
        Shrink(ball, a, b, frame.start[t].w);
      }
    if (ball.w != before) balls[i] = ball;
  } else {
    if (i >= frame.point_count || points[i].cleared != 0u) return;
    vec3 p = vec3(points[i].x, points[i].y, points[i].z);
    for (uint part = 0; part < 2; ++part)
      for (uint t = 0; t < frame.tool_count; ++t) {
        if (!InMask(t)) continue;
        vec3 a = part == 0 ? AtContact(t) : AtSlid(t), b = part == 0 ? AtSlid(t) : AtEnd(t);
        if (!Inside(p, a, b, frame.start[t].w)) continue;
        points[i].cleared = 1u;
        atomicAdd(frame.removed[points[i].material], points[i].units);  // whole numbers: exact in any order
        return;
      }
  }
}
