#version 460
#extension GL_GOOGLE_include_directive : require
// Before pass 1: lists the clusters of balls that the tool's way from the proxy to the pose asked for can meet. The list's
// order is scheduling's; nothing that is made from it depends on the order.
#include "common.glsl"

layout(constant_id = 0) const uint kBallClusters = 1;

void main() {
  uint c = gl_GlobalInvocationID.x;
  if (c >= kBallClusters) return;
  Active entry = Active(c, 0u, 0u);
  for (uint t = 0; t < frame.tool_count; ++t) {
    if (!PathMeetsBox(ball_clusters[c], frame.start[t].xyz, frame.goal[t].xyz, frame.start[t].w)) continue;
    if (t < 32) entry.tool_low |= 1u << t;
    else entry.tool_high |= 1u << (t - 32);
  }
  if (ball_clusters[c].alive != 0u && (entry.tool_low | entry.tool_high) != 0u)
    path_balls[atomicAdd(frame.path_balls.x, 1u)] = entry;
}
