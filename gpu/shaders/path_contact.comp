#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 1 where the lists have to be built: first contact on the tool's way with any ball of the clusters that the host found on
// it, one workgroup for each cluster if the device allows that many. The smallest fraction over all pairs, as bits: for one
// sign, doubles order like their bits, so atomicMin is exact and independent of scheduling.
#include "common.glsl"
#include "first_contact.glsl"

void main() {
  double s = 2.0lf;
  float first = 2.0, rounding = frame.rounding_mm;
  for (uint number = gl_WorkGroupID.x; number < frame.near_ball_clusters; number += gl_NumWorkGroups.x) {
    ClusterPairs item = cluster_pairs[number];
    for (uint k = gl_WorkGroupID.y * kLanes + gl_LocalInvocationID.x; k < kGroupSize; k += gl_NumWorkGroups.y * kLanes) {
      uint i = item.cluster * kGroupSize + k;
      vec4 ball = i < frame.ball_count ? BallAt(i) : vec4(0.0);
      uint end = ball.w > 0.0 ? item.first + item.count : 0u;
      for (uint ref = item.first; ref < end; ++ref) {
        uint t = tool_refs[ref];
        vec4 start = Start(t);
        float earliest = EarliestContact(ball.xyz - start.xyz, Goal(t) - start.xyz, start.w + ball.w, rounding);
        // a loop, since software drivers execute a branch even if no lane takes it
        for (uint may = earliest < first ? 0 : 1; may < 1; ++may) {
          dvec4 from = ExactStart(t);
          s = min(s, ExactFirstContact(dvec3(ball.xyz) - from.xyz, ExactGoal(t) - from.xyz, from.w + double(ball.w)));
          first = AtLeast(s);
        }
      }
    }
  }
  s = subgroupMin(s);
  if (subgroupElect() && s < 2.0lf) MIN_KEY(frame.contact_key, ToKey(s))
}
