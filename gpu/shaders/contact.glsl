// Pass 1 over the lists of the frames before: while the tool stays near where they were made, first contact is with one of
// them. Row 0: live balls and the balls that cut; row 1: pairs with those that do not.
#include "first_contact.glsl"

// The pair, where it may be met before what was found so far: float `first`, exactly `s`.
#define MEET_FIRST(ball, start, m, exact_start, exact_goal)                                     \
  {                                                                                             \
    float earliest = EarliestContact(ball.xyz - start.xyz, m, start.w + ball.w, rounding);      \
    for (uint may = ball.w > 0.0 && earliest < first ? 0 : 1; may < 1; ++may) {                 \
      dvec4 from = exact_start;                                                                 \
      s = min(s, ExactFirstContact(dvec3(ball.xyz) - from.xyz, exact_goal - from.xyz, from.w + double(ball.w))); \
      first = AtLeast(s);                                                                       \
    }                                                                                           \
  }

void FindContact(uint row) {
  double s = 2.0lf;
  float first = 2.0, rounding = frame.rounding_mm;
  uint end = Takes(row, 0u) ? ChunkEnd(frame.live_ball_count) : 0u;
  if (kOneCutter) {
    vec4 start = Start(0);
    vec3 m = Goal(0) - start.xyz;
    dvec4 only_start = ExactStart(0);
    dvec3 only_goal = ExactGoal(0);
    for (uint slot = ChunkBegin(); slot < end; slot += ChunkStep()) {
      vec4 ball = LiveBall(slot);
      MEET_FIRST(ball, start, m, only_start, only_goal)
    }
  } else {
    for (uint slot = ChunkBegin(); slot < end; slot += ChunkStep()) {
      vec4 ball = LiveBall(slot);
      Live entry = LiveEntry(slot);
      uint last = ball.w > 0.0 ? entry.first + entry.count : 0u;
      for (uint k = entry.first; k < last; ++k) {
        uint t = ToolOfSpan(k);
        vec4 start = Start(t);
        MEET_FIRST(ball, start, Goal(t) - start.xyz, ExactStart(t), ExactGoal(t))
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
      MEET_FIRST(ball, start, Goal(t) - start.xyz, ExactStart(t), ExactGoal(t))
    }
  }
  s = subgroupMin(s);
  if (subgroupElect() && s < 2.0lf) atomicMin(frame.contact_key, ToKey(s));
}
