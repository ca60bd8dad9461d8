// Rows 0 (balls that cut) and 2 (those that do not), the slide: pass 1 again, from first contact to the constrained target. Pairs that overlap by less than the
// tolerance may overlap up to it, or a tool would stick to every ball that stands out of a smooth wall. Row 1, engaged area:
// volume of the mass points within a layer of the cutting surface over the layer's depth, projected on the plane normal to
// the force (twin of ReferenceEngine::MeasureEngagement).
#include "first_contact.glsl"
#include "pairs.glsl"

#define GATHER_MATERIAL(number)                                  \
  {                                                              \
    int mask = material == number ? -1 : 0;                      \
    sum_##number += ivec2(area_units & mask, moment_units & mask); \
  }
#define FLUSH_MATERIAL(number)                                     \
  if (frame.material_count > number) {                             \
    ADD_TO(frame.engaged_sums[2 * number], sum_##number.x)         \
    ADD_TO(frame.engaged_sums[2 * number + 1], sum_##number.y)     \
  }

void SlideAndEngage(uint row) {
  bool go = frame.is_void == 0u;
  // with a turn, which may use a third of the tolerance: the rest is for going along whatever holds it; and straight
  bool turning = frame.turning != 0u;
  float at_contact = ContactFraction(), tolerance = frame.tolerance_mm, turn_tolerance = turning ? 0.35 * tolerance : tolerance;
  vec3 delta = frame.delta.xyz, shift = frame.shift_mm.xyz;
  vec4 only = AtContact(0, at_contact);  // the only cutter, where there is but one

  float s = 2.0, straight = 2.0;
  if (kOneCutter) {
    uint end = Takes(row, 0u) && go ? ChunkEnd(frame.live_ball_count) : 0u;
    vec3 m = Goal(0) + delta - only.xyz;
    for (uint slot = ChunkBegin(); slot < end; slot += ChunkStep()) {
      vec4 ball = LiveBall(slot);
      float own = FirstContactFraction(ball.xyz - only.xyz, m, only.w + ball.w - turn_tolerance);
      s = min(s, ball.w > 0.0 ? own : 2.0);
      own = FirstContactFraction(ball.xyz - only.xyz, shift, only.w + ball.w - tolerance);
      straight = min(straight, ball.w > 0.0 ? own : 2.0);
    }
  }
  // no tool ball goes farther than the slide may be
  float way = max(frame.slide_limit * frame.way_mm, frame.straight_limit * frame.straight_way_mm);
  for (uint list = FirstList(row, 2u); list <= LastList(row, 2u); ++list) {
    uint farthest = WordGap(Drift(list == kCutting, at_contact) + way);
    Walk walk = BeginWalk(list, 1u, go && row != 1u);
    while (NextPair(walk, farthest)) {
      vec4 ball = LiveBall(walk.slot), at = AtContact(ToolOf(walk.word), at_contact);
      vec3 m = Goal(ToolOf(walk.word)) + delta - at.xyz;
      float own = FirstContactFraction(ball.xyz - at.xyz, m, at.w + ball.w - turn_tolerance);
      s = min(s, ball.w > 0.0 ? own : 2.0);
      own = FirstContactFraction(ball.xyz - at.xyz, shift, at.w + ball.w - tolerance);
      straight = min(straight, ball.w > 0.0 ? own : 2.0);
    }
  }
  s = subgroupMin(s);
  straight = subgroupMin(straight);
  if (subgroupElect()) {
    if (s < 2.0) atomicMin(frame.slide_bits, floatBitsToUint(s));
    if (straight < 2.0) atomicMin(frame.straight_bits, floatBitsToUint(straight));
  }

  vec3 n = frame.n.xyz, axis = frame.axis_z.xyz, origin = OriginAtContact(at_contact);
  float layer = frame.layer_mm, area_scale = frame.area_scale, moment_scale = frame.moment_scale;
  uint end_points = Takes(row, 1u) && go && frame.delta.w > 0.0 ? ChunkEnd(frame.live_point_count) : 0u;
  ivec2 sum_0 = ivec2(0), sum_1 = sum_0, sum_2 = sum_0, sum_3 = sum_0, sum_4 = sum_0, sum_5 = sum_0, sum_6 = sum_0,
        sum_7 = sum_0;
  for (uint slot = ChunkBegin(); slot < end_points; slot += ChunkStep()) {
    vec4 point = LivePoint(slot);
    float nearest = layer, projection = 0.0;
    Live entry = PointEntry(slot);
    uint last = entry.first + (kOneCutter ? 1u : entry.count);
    uvec4 words = uvec4(0u);
    for (uint k = entry.first; k < last; ++k) {
      vec4 at = only;
      if (!kOneCutter) {
        words = k % 4u == 0u ? SpanWords(k) : words.yzwx;
        at = AtContact(ToolOf(words.x), at_contact);
      }
      vec3 away = point.xyz - at.xyz;
      float d = length(away), gap = d - at.w;
      bool nearer = abs(gap) < layer && gap < nearest;
      nearest = nearer ? gap : nearest;
      projection = nearer ? max(0.0, -dot(n, away) / max(d, 1e-20)) : projection;
    }
    float area = max(point.w, 0.0) / layer * projection;  // negative: cleared
    float arm = length(cross(point.xyz - origin, axis));
    int area_units = int(round(area * area_scale)), moment_units = int(round(area * arm * moment_scale));
    uint material = entry.more;
    GATHER_MATERIAL(0) GATHER_MATERIAL(1) GATHER_MATERIAL(2) GATHER_MATERIAL(3)
    GATHER_MATERIAL(4) GATHER_MATERIAL(5) GATHER_MATERIAL(6) GATHER_MATERIAL(7)
  }
  if (!Takes(row, 1u)) return;
  FLUSH_MATERIAL(0) FLUSH_MATERIAL(1) FLUSH_MATERIAL(2) FLUSH_MATERIAL(3)
  FLUSH_MATERIAL(4) FLUSH_MATERIAL(5) FLUSH_MATERIAL(6) FLUSH_MATERIAL(7)
}
