#version 460
#extension GL_GOOGLE_include_directive : require
// Measures the gaps of the lists' packed pairs anew at the proxy: with the tool's displacement grows the number of pairs that
// are tested although they are too far. Row 0: listed balls with the cutting balls; row 1: points; row 2: pairs with balls that
// do not cut.
#include "common.glsl"
#include "pairs.glsl"

void main() {
  uint row = Row(), list = row == 0u ? kCutting : row == 1u ? kPoint : kShaft;
  uint count = row == 0u ? frame.live_ball_count : row == 1u ? frame.live_point_count : frame.shaft_count;
  uint before = EntriesBefore(list);
  for (uint i = FirstEntry(); i < count; i += EntryStep()) {
    uvec4 entry = Entry(list, before + i);
    vec4 ball = list == kPoint ? vec4(LivePoint(i).xyz, 0.0) : LiveBall(list == kShaft ? entry.x : i);
    uint min_gap = kMaxPackedGap, last = entry.y + entry.z;
    uvec4 pairs = uvec4(0u);
    for (uint k = entry.y; k < last; ++k) {
      pairs = k % 4u == 0u ? PackedPairsAt(k) : pairs.yzwx;
      uint t = ToolOf(pairs.x), gap = PackGap(ball, Start(t));
      min_gap = min(min_gap, gap);
      packed_pairs[k] = gap << kToolBits | t;
    }
    if (list != kPoint) live_entries[before + i].more = min_gap;
  }
}
