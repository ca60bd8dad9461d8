#version 460
#extension GL_GOOGLE_include_directive : require
// Finds the tool ball that touches first, where it alone cuts; among those that touch at the same time, the first in the tool's
// own order (equivalent to ReferenceEngine::FirstTouchingBall). First contact is known, and the lists hold whatever touches there.
// Row 0: listed balls with the cutting balls; row 1: pairs with balls that do not cut.
#include "common.glsl"
#include "first_contact.glsl"
#include "pairs.glsl"

const double kTieTolerance_mm = 1e3 * kTieTolerance_m;

// Key of a tool ball that is smallest for the first ball in the tool's own order.
uint KeyOf(uint t) { return uint(texelFetch(tool_texels, int(2u * t + 1u)).w) << kToolBits | t; }

// Float test: whether the pair may be met at fraction `last` of the path or before.
bool MayTouch(vec4 ball, uint t, float last, float rounding) {
  vec4 start = Start(t);
  return ball.w > 0.0 && EarliestContact(ball.xyz - start.xyz, Goal(t) - start.xyz, start.w + ball.w, rounding) <= last;
}
bool Touches(vec4 ball, uint t, double last) {
  dvec4 start = ExactStart(t);
  return ExactFirstContact(dvec3(ball.xyz) - start.xyz, ExactGoal(t) - start.xyz, start.w + double(ball.w)) <= last;
}

void main() {
  uint row = Row(), key = kNoToolBall;
  double s = FromKey(frame.contact_key), last = min(1.0lf, s + kTieTolerance_mm / double(frame.path_mm));
  bool met = s < 2.0lf;
  float last_f32 = AtLeast(last), rounding = frame.rounding_mm;
  if (kOneCutter) {
    uint slot = FirstEntry(), end = row == 0u && met ? frame.live_ball_count : 0u;
    while (slot < end) {
      vec4 ball;
      bool may = false;
      while (slot < end && !may) {
        ball = LiveBall(slot);
        may = MayTouch(ball, 0u, last_f32, rounding);
        slot += EntryStep();
      }
      if (!may || !Touches(ball, 0u, last)) continue;
      key = KeyOf(0u);
      slot = end;
    }
  }
  for (uint list = FirstList(row, 1u); list <= LastList(row, 1u); ++list) {
    uint farthest = PackedGapLimit(Displacement(list == kCutting, float(s)));
    Walk walk = BeginWalk(list, met);
    for (bool more = true; more;) {
      vec4 ball;
      bool may = false;
      while (!may) {
        more = NextPair(walk, farthest);
        if (!more) break;
        ball = LiveBall(walk.slot);
        may = KeyOf(ToolOf(walk.pair)) < key && MayTouch(ball, ToolOf(walk.pair), last_f32, rounding);
      }
      if (may && Touches(ball, ToolOf(walk.pair), last)) key = KeyOf(ToolOf(walk.pair));
    }
  }
  key = subgroupMin(key);
  if (subgroupElect() && key != kNoToolBall) atomicMin(frame.touching, key);
}
