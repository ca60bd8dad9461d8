// Pass 1 over the lists of the frames before: while the tool stays near where they were made, first contact is with one of
// them. Row 0: live balls and the balls that cut; row 1: pairs with those that do not.
#include "first_contact.glsl"

void FindContact(uint row) {
  float s = 2.0;
  uint end = Takes(row, 0u) ? ChunkEnd(frame.live_ball_count) : 0u;
  if (kOneCutter) {
    vec4 start = Start(0);
    vec3 m = Goal(0) - start.xyz;
    for (uint slot = ChunkBegin(); slot < end; slot += ChunkStep()) {
      vec4 ball = LiveBall(slot);
      float own = FirstContactFraction(ball.xyz - start.xyz, m, start.w + ball.w);
      s = min(s, ball.w > 0.0 ? own : 2.0);
    }
  } else {
    for (uint slot = ChunkBegin(); slot < end; slot += ChunkStep()) {
      vec4 ball = LiveBall(slot);
      Live entry = LiveEntry(slot);
      uint last = ball.w > 0.0 ? entry.first + entry.count : 0u;
      for (uint k = entry.first; k < last; ++k) {
        uint t = ToolOfSpan(k);
        vec4 start = Start(t);
        s = min(s, FirstContactFraction(ball.xyz - start.xyz, Goal(t) - start.xyz, start.w + ball.w));
      }
    }
  }
  end = Takes(row, 1u) ? ChunkEnd(frame.shaft_count) : 0u;
  for (uint slot = ChunkBegin(); slot < end; slot += ChunkStep()) {
    ShaftPair pair = shaft_pairs[slot];
    vec4 ball = LiveBall(pair.slot);
    uint last = ball.w > 0.0 ? pair.first + pair.count : 0u;
    for (uint k = pair.first; k < last; ++k) {
      uint t = ToolOfSpan(k);
      vec4 start = Start(t);
      s = min(s, FirstContactFraction(ball.xyz - start.xyz, Goal(t) - start.xyz, start.w + ball.w));
    }
  }
  s = subgroupMin(s);
  if (subgroupElect() && s < 2.0) atomicMin(frame.contact_bits, floatBitsToUint(s));
}
