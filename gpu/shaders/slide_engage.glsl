// Rows 0 and 1, the slide: pass 1 again, from first contact to the constrained target. Pairs that overlap by less than the
// tolerance may overlap up to it, or a tool would stick to every ball that stands out of a smooth wall. Row 2, engaged area:
// volume of the mass points within a layer of the cutting surface over the layer's depth, projected on the plane normal to
// the force (twin of ReferenceEngine::MeasureEngagement).
#include "first_contact.glsl"

#define GATHER_MATERIAL(number) sum_##number += material == number ? units : dvec2(0.0lf);
#define FLUSH_MATERIAL(number)                                              \
  if (frame.material_count > number) {                                      \
    ADD_FINE(frame.exact.engaged[2 * number], int64_t(sum_##number.x))      \
    ADD_FINE(frame.exact.engaged[2 * number + 1], int64_t(sum_##number.y))  \
  }

// The pair, where it may be met before what was found so far: with the turn, and straight.
#define MEET_AGAIN(ball, at, m, exact_at, exact_goal)                                                                \
  {                                                                                                                  \
    vec3 D = ball.xyz - at.xyz;                                                                                      \
    float R = at.w + ball.w, earliest = EarliestContact(D, m, R - turn_tolerance, rounding), other = 2.0;            \
    for (uint twice = turning ? 0 : 1; twice < 1; ++twice) other = EarliestContact(D, shift, R - tolerance, rounding); \
    for (uint may = ball.w > 0.0 && (earliest < first || other < first_straight) ? 0 : 1; may < 1; ++may) {          \
      dvec4 from = exact_at;                                                                                         \
      dvec3 exact_D = dvec3(ball.xyz) - from.xyz;                                                                    \
      double exact_R = from.w + double(ball.w);                                                                      \
      s = min(s, ExactFirstContact(exact_D, exact_goal + exact_delta - from.xyz, exact_R - exact_turn_tolerance));   \
      first = AtLeast(s);                                                                                            \
      for (uint twice = turning ? 0 : 1; twice < 1; ++twice)                                                         \
        straight = min(straight, ExactFirstContact(exact_D, exact_shift, exact_R - exact_tolerance));                \
      first_straight = AtLeast(straight);                                                                            \
    }                                                                                                                \
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
    double exact_s = ExactFraction(), exact_tolerance = frame.exact.tolerance,
           exact_turn_tolerance = (turning ? 0.35lf : 1.0lf) * exact_tolerance;
    dvec3 exact_delta = frame.exact.delta, exact_shift = frame.exact.shift, only_goal = ExactGoal(0);
    dvec4 exact_only = ExactAtContact(0, exact_s);
    float at_contact = float(exact_s), rounding = frame.rounding_mm, tolerance = frame.tolerance_mm,
          turn_tolerance = turning ? 0.35 * tolerance : tolerance;
    vec3 delta = frame.delta.xyz;
    vec4 only = AtContact(0, at_contact);  // the only cutter, where there is but one

    double s = 2.0lf, straight = 2.0lf;
    float first = 2.0, first_straight = 2.0;
    vec3 shift = frame.shift_mm.xyz;
    vec3 m = Goal(0) + delta - only.xyz;
    for (uint slot = ChunkBegin(); slot < end_balls; slot += ChunkStep()) {
      vec4 ball = LiveBall(slot);
      if (kOneCutter) {
        MEET_AGAIN(ball, only, m, exact_only, only_goal)
      } else {
        Live entry = LiveEntry(slot);
        uint last = ball.w > 0.0 ? entry.first + entry.count : 0u;
        for (uint k = entry.first; k < last; ++k) {
          uint t = ToolOfSpan(k);
          vec4 at = AtContact(t, at_contact);
          MEET_AGAIN(ball, at, Goal(t) + delta - at.xyz, ExactAtContact(t, exact_s), ExactGoal(t))
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
        MEET_AGAIN(ball, at, Goal(t) + delta - at.xyz, ExactAtContact(t, exact_s), ExactGoal(t))
      }
    }
    s = subgroupMin(s);
    straight = subgroupMin(straight);
    if (subgroupElect()) {
      if (s < 2.0lf) atomicMin(frame.slide_key, ToKey(s));
      if (straight < 2.0lf) atomicMin(frame.straight_key, ToKey(straight));
    }

    double exact_layer = frame.exact.layer, per_layer = 1.0lf / exact_layer;
    double area_scale = kFiner * double(frame.area_scale), moment_scale = kFiner * double(frame.moment_scale);
    dvec3 n = frame.exact.n, axis = frame.exact.axis, start = frame.exact.start,
          origin = start + exact_s * (frame.exact.goal - start);
    float layer = frame.layer_mm + rounding;
    // whole numbers below 2^53: their sums are exact
    dvec2 sum_0 = dvec2(0.0lf), sum_1 = sum_0, sum_2 = sum_0, sum_3 = sum_0, sum_4 = sum_0, sum_5 = sum_0, sum_6 = sum_0,
          sum_7 = sum_0;
    for (uint slot = ChunkBegin(); slot < end_points; slot += ChunkStep()) {
      vec4 point = LivePoint(slot);
      double nearest = exact_layer, projection = 0.0lf;
      float nearly = layer;
      Live entry = PointEntry(slot);
      if (kOneCutter) entry.count = 1u;
      uint last = point.w > 0.0 ? entry.first + entry.count : 0u;  // negative: cleared
      for (uint k = entry.first; k < last; ++k) {
        uint t = 0u;
        vec4 at = only;
        if (!kOneCutter) {
          t = ToolOfSpan(k);
          at = AtContact(t, at_contact);
        }
        float gap = distance(point.xyz, at.xyz) - at.w;
        // most points of the list are out of the layer
        for (uint may = abs(gap) < layer && gap < nearly ? 0 : 1; may < 1; ++may) {
          dvec4 from = exact_only;
          if (!kOneCutter) from = ExactAtContact(t, exact_s);
          dvec3 away = dvec3(point.xyz) - from.xyz;
          double d = length(away), exact_gap = d - from.w;
          bool nearer = abs(exact_gap) < exact_layer && exact_gap < nearest;
          nearest = nearer ? exact_gap : nearest;
          nearly = nearer ? float(exact_gap) + rounding : nearly;
          projection = nearer ? max(0.0lf, -dot(n, away) / max(d, 1e-20lf)) : projection;
        }
      }
      for (uint inner = projection > 0.0lf ? 0 : 1; inner < 1; ++inner) {
        double area = double(point.w) * per_layer * projection;
        dvec2 units = Rounded(area * dvec2(area_scale, length(cross(dvec3(point.xyz) - origin, axis)) * moment_scale));
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
