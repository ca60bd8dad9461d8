#version 460
#extension GL_GOOGLE_include_directive : require
// Lists the balls within reach of the tool.
#include "common.glsl"
#include "pick.glsl"

void main() {
  Item item = items[gl_WorkGroupID.x];
  float s = ListFraction();
  float cutting_reach = frame.ball_reach_mm + frame.cutting_margin_mm;
  float shaft_reach = frame.ball_reach_mm + frame.shaft_margin_mm;
  // a cluster that no such ball can meet has no groups of them
  bool any_shaft = tool_groups[group_refs[item.first + item.count - 1u]].first >= frame.cutter_count;
  for (uint k = gl_LocalInvocationID.x; k < kGroupSize; k += kLanes) {
    uint i = item.cluster * kGroupSize + k;
    vec4 ball = i < frame.ball_count ? BallAt(i) : vec4(0.0);
    bool live = ball.w > 0.0;
    Span cutting = FindSpan(item, ball.xyz, ball.w, cutting_reach, s, true, live);
    Span shaft = Span(0u, 0u);
    if (any_shaft) shaft = FindSpan(item, ball.xyz, ball.w, shaft_reach, s, false, live);
    if (cutting.count + shaft.count == 0u) continue;
    NEXT_SLOT(slot, frame.live_ball_count)
    if (slot >= frame.live_capacity) {
      frame.too_many = 1u;
      continue;
    }
    live_balls[slot] = ball;
    slots[i] = slot;
    live_entries[slot] = Live(i, cutting.first, cutting.count, 0u);
    if (shaft.count == 0u) continue;
    NEXT_SLOT(pair, frame.shaft_count)
    shaft_pairs[pair] = ShaftPair(slot, shaft.first, shaft.count);
  }
}
