// Pass 1 over the lists of the frames before: while the tool stays near where they were made, first contact is with one of
// them. Row 0: live balls and the balls that cut; row 1: pairs with those that do not.
#include "first_contact.glsl"
#include "pairs.glsl"

void FindContact(uint row) {
  // what others have found already bounds the way that is of interest
  float s = uintBitsToFloat(frame.contact_bits);
  if (kOneCutter) {
    uint end = Takes(row, 0u) ? ChunkEnd(frame.live_ball_count) : 0u;
    vec4 start = Start(0);
    vec3 m = Goal(0) - start.xyz;
    for (uint slot = ChunkBegin(); slot < end; slot += ChunkStep()) {
      vec4 ball = LiveBall(slot);
      float own = FirstContactFraction(ball.xyz - start.xyz, m, start.w + ball.w);
      s = min(s, ball.w > 0.0 ? own : 2.0);
    }
  }
  for (uint list = FirstList(row, 1u); list <= LastList(row, 1u); ++list) {
    float drift = Drift(list == kCutting, 0.0), path = frame.path_mm;
    Walk walk = BeginWalk(list, 1u, true);
    while (NextPair(walk, WordGap(drift + s * path))) {
      vec4 ball = LiveBall(walk.slot), start = Start(ToolOf(walk.word));
      float own = FirstContactFraction(ball.xyz - start.xyz, Goal(ToolOf(walk.word)) - start.xyz, start.w + ball.w);
      s = min(s, ball.w > 0.0 ? own : 2.0);
    }
  }
  s = subgroupMin(s);
  if (subgroupElect() && s < 2.0) atomicMin(frame.contact_bits, floatBitsToUint(s));
}
