// Rows 0 and 1, the slide: pass 1 again, from first contact to the constrained target. Pairs that overlap by less than the
// tolerance may overlap up to it, or a tool would stick to every ball that stands out of a smooth wall. Row 2, engaged area:
// volume of the mass points within a layer of the cutting surface over the layer's depth, projected on the plane normal to
// the force (twin of ReferenceEngine::MeasureEngagement).
#include "first_contact.glsl"

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
  uint end_balls = Takes(row, 0u) && go ? ChunkEnd(frame.live_ball_count) : 0u;
  uint end_shaft = Takes(row, 1u) && go ? ChunkEnd(frame.shaft_count) : 0u;
  uint end_points = Takes(row, 2u) && go && frame.delta.w > 0.0 ? ChunkEnd(frame.live_point_count) : 0u;
  // nothing to do: a loop, since software drivers execute a branch that nobody takes
  for (uint once = ChunkBegin() < max(end_balls, max(end_shaft, end_points)) ? 0 : 1; once < 1; ++once) {
    // with a turn, which may use a third of the tolerance: the rest is for going along whatever holds it; and straight
    bool turning = frame.turning != 0u;
    float at_contact = ContactFraction(), tolerance = frame.tolerance_mm, turn_tolerance = turning ? 0.35 * tolerance : tolerance;
    vec3 delta = frame.delta.xyz;
    vec4 only = AtContact(0, at_contact);  // the only cutter, where there is but one

    float s = 2.0, straight = 2.0;
    vec3 shift = frame.shift_mm.xyz;
    vec3 m = Goal(0) + delta - only.xyz;
    for (uint slot = ChunkBegin(); slot < end_balls; slot += ChunkStep()) {
      vec4 ball = LiveBall(slot);
      if (kOneCutter) {
        float own = FirstContactFraction(ball.xyz - only.xyz, m, only.w + ball.w - turn_tolerance);
        s = min(s, ball.w > 0.0 ? own : 2.0);
        for (uint twice = turning ? 0 : 1; twice < 1; ++twice) {
          own = FirstContactFraction(ball.xyz - only.xyz, shift, only.w + ball.w - tolerance);
          straight = min(straight, ball.w > 0.0 ? own : 2.0);
        }
      } else {
        Live entry = LiveEntry(slot);
        uint last = ball.w > 0.0 ? entry.first + entry.count : 0u;
        for (uint k = entry.first; k < last; ++k) {
          uint t = ToolOfSpan(k);
          vec4 at = AtContact(t, at_contact);
          s = min(s, FirstContactFraction(ball.xyz - at.xyz, Goal(t) + delta - at.xyz, at.w + ball.w - turn_tolerance));
          straight = min(straight, FirstContactFraction(ball.xyz - at.xyz, shift, at.w + ball.w - tolerance));
        }
      }
    }
    for (uint slot = ChunkBegin(); slot < end_shaft; slot += ChunkStep()) {
      ShaftPair pair = shaft_pairs[slot];
      vec4 ball = LiveBall(pair.slot);
      uint last = ball.w > 0.0 ? pair.first + pair.count : 0u;
      for (uint k = pair.first; k < last; ++k) {
        uint t = ToolOfSpan(k);
        vec4 at = AtContact(t, at_contact);
        s = min(s, FirstContactFraction(ball.xyz - at.xyz, Goal(t) + delta - at.xyz, at.w + ball.w - turn_tolerance));
        straight = min(straight, FirstContactFraction(ball.xyz - at.xyz, shift, at.w + ball.w - tolerance));
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
    ivec2 sum_0 = ivec2(0), sum_1 = sum_0, sum_2 = sum_0, sum_3 = sum_0, sum_4 = sum_0, sum_5 = sum_0, sum_6 = sum_0,
          sum_7 = sum_0;
    for (uint slot = ChunkBegin(); slot < end_points; slot += ChunkStep()) {
      vec4 point = LivePoint(slot);
      float nearest = layer, projection = 0.0;
      Live entry = PointEntry(slot);
      if (kOneCutter) entry.count = 1u;
      uint last = point.w > 0.0 ? entry.first + entry.count : 0u;  // negative: cleared
      for (uint k = entry.first; k < last; ++k) {
        vec4 at = only;
        if (!kOneCutter) at = AtContact(ToolOfSpan(k), at_contact);
        vec3 away = point.xyz - at.xyz;
        float d = length(away), gap = d - at.w;
        bool nearer = abs(gap) < layer && gap < nearest;
        nearest = nearer ? gap : nearest;
        projection = nearer ? max(0.0, -dot(n, away) / max(d, 1e-20)) : projection;
      }
      // most points of the list are out of the layer
      for (uint inner = projection > 0.0 ? 0 : 1; inner < 1; ++inner) {
        float area = point.w / layer * projection;
        float arm = length(cross(point.xyz - origin, axis));
        int area_units = int(round(area * area_scale)), moment_units = int(round(area * arm * moment_scale));
        uint material = entry.material;
        GATHER_MATERIAL(0) GATHER_MATERIAL(1) GATHER_MATERIAL(2) GATHER_MATERIAL(3)
        GATHER_MATERIAL(4) GATHER_MATERIAL(5) GATHER_MATERIAL(6) GATHER_MATERIAL(7)
      }
    }
    if (!Takes(row, 2u)) continue;
    FLUSH_MATERIAL(0) FLUSH_MATERIAL(1) FLUSH_MATERIAL(2) FLUSH_MATERIAL(3)
    FLUSH_MATERIAL(4) FLUSH_MATERIAL(5) FLUSH_MATERIAL(6) FLUSH_MATERIAL(7)
  }
}
