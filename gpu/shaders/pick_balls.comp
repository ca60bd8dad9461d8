#version 460
#extension GL_GOOGLE_include_directive : require
// Lists the balls within reach of the tool.
#include "common.glsl"
#include "pick.glsl"

void main() {
  float s = ListFraction();
  float cutting_reach = frame.ball_reach_mm + frame.cutting_skin_mm;
  float shaft_reach = frame.ball_reach_mm + frame.shaft_skin_mm;
  for (uint number = gl_WorkGroupID.x; number < frame.near_ball_clusters; number += gl_NumWorkGroups.x) {
    ClusterPairs item = cluster_pairs[number];
    uint middle = item.first + item.cutters, last = item.first + item.count;
    for (uint k = gl_WorkGroupID.y * kLanes + gl_LocalInvocationID.x; k < kGroupSize; k += gl_NumWorkGroups.y * kLanes) {
      uint i = item.cluster * kGroupSize + k;
      vec4 ball = i < frame.ball_count ? BallAt(i) : vec4(0.0);
      bool live = ball.w > 0.0;
      PairRange cutting = FindPairRange(item.first, middle, ball.xyz, ball.w, cutting_reach, s, true, live);
      PairRange shaft = FindPairRange(middle, last, ball.xyz, ball.w, shaft_reach, s, false, live);
      if (cutting.count + shaft.count == 0u) continue;
      NEXT_SLOT(slot, frame.live_ball_count)
      if (slot >= frame.live_capacity) {
        frame.list_overflow = 1u;
        continue;
      }
      live_balls[slot] = ball;
      slots[i] = slot;
      live_entries[slot] = ListEntry(i, cutting.first, cutting.count, cutting.min_gap);
      if (shaft.count == 0u) continue;
      NEXT_SLOT(pair, frame.shaft_count)
      live_entries[frame.live_capacity + pair] = ListEntry(slot, shaft.first, shaft.count, shaft.min_gap);
    }
  }
}
