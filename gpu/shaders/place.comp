#version 460
#extension GL_GOOGLE_include_directive : require
// After pass 1, one workgroup: where the tool's balls are at first contact; everything after it reads this. Where that is too
// far from where the lists of live balls and points were made (or there are none), orders them anew: pass 1 over all
// clusters on the tool's way, this pass again, and the lists.
#include "common.glsl"

layout(constant_id = 0) const uint kBallClusters = 1;
layout(constant_id = 1) const uint kPointClusters = 1;

shared uint far;

uint GroupsFor(uint invocations) { return (invocations + kGroupSize - 1) / kGroupSize; }

void main() {
  uint lane = gl_LocalInvocationID.x;
  bool second = frame.rebuilt != 0u;
  if (lane == 0) far = frame.lists_serve == 0u ? 1u : 0u;
  barrier();
  for (uint t = lane; t <= frame.tool_count; t += kGroupSize) {
    vec4 at = vec4(mix(frame.start[t].xyz, frame.goal[t].xyz, ContactFraction()), frame.start[t].w);
    frame.contact[t] = at;
    if (distance(at.xyz, frame.built[t].xyz) > frame.built[t].w) atomicOr(far, 1u);
  }
  barrier();
  if (lane != 0 || second || far == 0u) return;
  frame.rebuilt = 1u;
  frame.contact_bits = floatBitsToUint(2.0);
  frame.live_ball_count = 0u;
  frame.live_point_count = 0u;
  frame.live_balls.x = 0u;
  frame.live_points.x = 0u;
  frame.shaft_balls.x = 0u;
  frame.reach_groups.x = GroupsFor(kBallClusters);
  frame.near_groups.x = GroupsFor(kBallClusters + kPointClusters);
  frame.place_groups.x = 1u;
}
