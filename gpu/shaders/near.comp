#version 460
#extension GL_GOOGLE_include_directive : require
// After pass 1: lists the clusters of balls and of points within reach of the tool at first contact.
#include "common.glsl"

layout(constant_id = 0) const uint kBallClusters = 1;
layout(constant_id = 1) const uint kPointClusters = 1;

void main() {
  uint c = gl_GlobalInvocationID.x;
  if (c >= kBallClusters + kPointClusters) return;
  bool is_ball = c < kBallClusters;
  uint own = is_ball ? c : c - kBallClusters;
  Cluster box;
  if (is_ball) box = ball_clusters[own];
  else box = point_clusters[own];
  float reach = is_ball ? frame.ball_reach_mm : frame.point_reach_mm;
  Active entry = Active(own, 0u, 0u);
  for (uint t = 0; t < frame.tool_count; ++t) {
    if (BoxDistance(box, frame.contact[t].xyz) > frame.contact[t].w + reach + frame.built[t].w) continue;
    if (t < 32) entry.tool_low |= 1u << t;
    else entry.tool_high |= 1u << (t - 32);
  }
  if (box.alive == 0u || (entry.tool_low | entry.tool_high) == 0u) return;
  if (is_ball) near_balls[atomicAdd(frame.near_balls.x, 1u)] = entry;
  else near_points[atomicAdd(frame.near_points.x, 1u)] = entry;
}
