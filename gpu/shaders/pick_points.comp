#version 460
#extension GL_GOOGLE_include_directive : require
// Lists the mass points within reach of the cutting balls, without cleared ones.
#include "common.glsl"
#include "pick.glsl"

layout(constant_id = 2) const uint kBallClusters = 0;

void main() {
  float s = ListFraction(), reach = frame.point_reach_mm + frame.cutting_skin_mm;
  for (uint number = gl_WorkGroupID.x; number < frame.near_point_clusters; number += gl_NumWorkGroups.x) {
    ClusterPairs item = cluster_pairs[kBallClusters + number];
    for (uint k = gl_WorkGroupID.y * kLanes + gl_LocalInvocationID.x; k < kGroupSize; k += gl_NumWorkGroups.y * kLanes) {
      uint i = item.cluster * kGroupSize + k;
      bool live = i < frame.point_count;
      vec4 point = live ? points[i] : vec4(0.0);
      PairRange cutting = FindPairRange(item.first, item.first + item.cutters, point.xyz, 0.0, reach, s, true, live);
      if (cutting.count == 0u) continue;
      uint state = point_states[i];
      if (state >= kCleared) continue;
      NEXT_SLOT(slot, frame.live_point_count)
      if (slot >= frame.live_capacity) {
        frame.list_overflow = 1u;
        continue;
      }
      live_points[slot] = point;
      point_entries[slot] = ListEntry(i, cutting.first, cutting.count, state);
    }
  }
}
