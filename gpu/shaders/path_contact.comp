#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 1 where the lists have to be made: first contact on the tool's way with any ball of the clusters that the host has
// found on it, a workgroup each. The smallest fraction over all pairs, as bits: floats of one sign order like their bits, so
// that atomicMin is exact and independent of scheduling.
#include "common.glsl"
#include "first_contact.glsl"

void main() {
  Item item = items[gl_WorkGroupID.x];
  float s = 2.0;
  for (uint k = gl_WorkGroupID.y * kLanes + gl_LocalInvocationID.x; k < kGroupSize; k += gl_NumWorkGroups.y * kLanes) {
    uint i = item.cluster * kGroupSize + k;
    vec4 ball = i < frame.ball_count ? BallAt(i) : vec4(0.0);
    uint end = ball.w > 0.0 ? item.first + item.count : 0u;
    for (uint ref = item.first; ref < end; ++ref) {
      uint t = tool_refs[ref];
      vec4 start = Start(t);
      s = min(s, FirstContactFraction(ball.xyz - start.xyz, Goal(t) - start.xyz, start.w + ball.w));
    }
  }
  s = subgroupMin(s);
  if (subgroupElect() && s < 2.0) atomicMin(frame.contact_bits, floatBitsToUint(s));
}
