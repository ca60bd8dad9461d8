#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 1 over the lists of earlier frames: while the tool stays near where they were built, first contact is with one of their
// entries. Row 0: listed balls with the cutting balls; row 1: pairs with balls that do not cut.
#include "common.glsl"
#include "first_contact.glsl"
#include "pairs.glsl"

void main() {
  uint row = Row();
  // contacts that other invocations have found already shorten the path to search
  double s = FromKey(frame.contact_key);
  float first = AtLeast(s), rounding = frame.rounding_mm;
  if (kOneCutter) {
    vec4 start = Start(0);
    vec3 m = Goal(0) - start.xyz;
    dvec4 exact_start = ExactStart(0);
    dvec3 exact_m = ExactGoal(0) - exact_start.xyz;
    uint slot = FirstEntry(), end = row == 0u ? frame.live_ball_count : 0u;
    while (slot < end) {
      vec4 ball;
      bool may = false, any = false;
      while (slot < end && !any) {
        ball = LiveBall(slot);
        may = ball.w > 0.0 && EarliestContact(ball.xyz - start.xyz, m, start.w + ball.w, rounding) < first;
        any = subgroupAny(may);
        slot += EntryStep();
      }
      double own = ExactFirstContact(dvec3(ball.xyz) - exact_start.xyz, exact_m, exact_start.w + double(ball.w));
      s = may ? min(s, own) : s;
      first = AtLeast(s);
    }
  }
  for (uint list = FirstList(row, 1u); list <= LastList(row, 1u); ++list) {
    float displacement = Displacement(list == kCutting, 0.0), path = frame.path_mm;
    Walk walk = BeginWalk(list, true);
    for (bool more = true; more;) {
      vec4 ball;
      bool may = false;
      while (!may) {
        more = NextPair(walk, PackedGapLimit(displacement + first * path));
        if (!more) break;
        ball = LiveBall(walk.slot);
        vec4 start = Start(ToolOf(walk.pair));
        vec3 m = Goal(ToolOf(walk.pair)) - start.xyz;
        may = ball.w > 0.0 && EarliestContact(ball.xyz - start.xyz, m, start.w + ball.w, rounding) < first;
      }
      if (!may) continue;
      dvec4 start = ExactStart(ToolOf(walk.pair));
      dvec3 m = ExactGoal(ToolOf(walk.pair)) - start.xyz;
      s = min(s, ExactFirstContact(dvec3(ball.xyz) - start.xyz, m, start.w + double(ball.w)));
      first = AtLeast(s);
    }
  }
  s = subgroupMin(s);
  if (subgroupElect() && s < 2.0lf) MIN_KEY(frame.contact_key, ToKey(s))
}
