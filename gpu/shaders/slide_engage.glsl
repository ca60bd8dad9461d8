// Rows 0 and 1, the slide: pass 1 again, from first contact to the constrained target. Pairs that overlap by less than the
// tolerance may overlap up to it, or a tool would stick to every ball that stands out of a smooth wall. Row 2, engaged area:
// volume of the mass points within a layer of the cutting surface over the layer's depth, projected on the plane normal to
// the force (twin of ReferenceEngine::MeasureEngagement).
#include "first_contact.glsl"

#define GATHER_MATERIAL(number)                  \
  {                                              \
    int64_t mask = material == number ? -1L : 0L; \
    area_##number += area_units & mask;          \
    moment_##number += moment_units & mask;      \
  }
#define FLUSH_MATERIAL(number)                                   \
  if (frame.material_count > number) {                           \
    ADD_FINE(frame.exact.engaged[2 * number], area_##number)       \
    ADD_FINE(frame.exact.engaged[2 * number + 1], moment_##number) \
  }
// The pair, where it may be met before what was found so far: with the turn, and straight.
#define MEET_AGAIN(ball, t, at, m)                                                                              \
  {                                                                                                       \
    vec3 D = ball.xyz - at.xyz;                                                                           \
    float R = at.w + ball.w;                                                                              \
    float earliest = EarliestContact(D, m, R - turn_tolerance, rounding), other = 2.0;                    \
    for (uint twice = turning ? 0 : 1; twice < 1; ++twice) other = EarliestContact(D, shift, R - tolerance, rounding); \
    for (uint may = ball.w > 0.0 && (earliest < first || other < first_straight) ? 0 : 1; may < 1; ++may) { \
      dvec4 from = ExactAtContact(t, exact_s);                                                            \
      dvec3 D = dvec3(ball.xyz) - from.xyz;                                                               \
      double R = from.w + double(ball.w);                                                                 \
      s = min(s, ExactFirstContact(D, ExactGoal(t) + frame.exact.delta - from.xyz, R - exact_turn_tolerance)); \
      first = AtLeast(s);                                                                                 \
      for (uint twice = turning ? 0 : 1; twice < 1; ++twice)                                              \
        straight = min(straight, ExactFirstContact(D, frame.exact.shift, R - frame.exact.tolerance));     \
      first_straight = AtLeast(straight);                                                                 \
    }                                                                                                     \
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
    double exact_s = ExactFraction(), exact_turn_tolerance = (turning ? 0.35lf : 1.0lf) * frame.exact.tolerance;
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
        MEET_AGAIN(ball, 0u, only, m)
      } else {
        Live entry = LiveEntry(slot);
        uint last = ball.w > 0.0 ? entry.first + entry.count : 0u;
        for (uint k = entry.first; k < last; ++k) {
          uint t = ToolOfSpan(k);
          vec4 at = AtContact(t, at_contact);
          MEET_AGAIN(ball, t, at, Goal(t) + delta - at.xyz)
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
        MEET_AGAIN(ball, t, at, Goal(t) + delta - at.xyz)
      }
    }
    s = subgroupMin(s);
    straight = subgroupMin(straight);
    if (subgroupElect()) {
      if (s < 2.0lf) atomicMin(frame.slide_key, ToKey(s));
      if (straight < 2.0lf) atomicMin(frame.straight_key, ToKey(straight));
    }

    float layer = frame.layer_mm + rounding;
    int64_t area_0 = 0L, area_1 = 0L, area_2 = 0L, area_3 = 0L, area_4 = 0L, area_5 = 0L, area_6 = 0L, area_7 = 0L;
    int64_t moment_0 = 0L, moment_1 = 0L, moment_2 = 0L, moment_3 = 0L, moment_4 = 0L, moment_5 = 0L, moment_6 = 0L,
            moment_7 = 0L;
    dvec4 exact_only = ExactAtContact(0, exact_s);
    dvec3 n = frame.exact.n, axis = frame.exact.axis;
    dvec3 origin = frame.exact.start + exact_s * (frame.exact.goal - frame.exact.start);
    double area_scale = kFiner * double(frame.area_scale), moment_scale = kFiner * double(frame.moment_scale);
    for (uint slot = ChunkBegin(); slot < end_points; slot += ChunkStep()) {
      vec4 point = LivePoint(slot);
      double nearest = frame.exact.layer, projection = 0.0lf;
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
          if (abs(exact_gap) >= frame.exact.layer || exact_gap >= nearest) continue;
          nearest = exact_gap;
          nearly = float(nearest) + rounding;
          projection = d > 0.0lf ? max(0.0lf, -dot(n, away) / d) : 0.0lf;
        }
      }
      for (uint inner = projection > 0.0lf ? 0 : 1; inner < 1; ++inner) {
        double area = double(point.w) / frame.exact.layer * projection;
        double arm = length(cross(dvec3(point.xyz) - origin, axis));
        int64_t area_units = int64_t(area * area_scale + 0.5lf), moment_units = int64_t(area * arm * moment_scale + 0.5lf);
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
