// Pass 3: every cutting ball's capsules (first contact to slid, slid to end of the advance) take their share of each live ball
// (row 0; equation 5, corrected; twin of simulation::ShrinkBall), one invocation a ball, and clear the mass points in them
// (row 2), each once and booked in whole units of volume: the result does not depend on scheduling. The list's copies are the
// balls from here on, until flush.comp writes them back.
#include "rate_law.glsl"

const double kLeastBallRadius = 1e-3lf;  // mm
const double kOnAxis = 1e-3lf;           // simulation::kOnAxis

// One piece of a cutting ball's path.
struct Capsule {
  vec3 a, m;  // from a to a + m
  float per_mm2;  // 1 / m²; 0 where nothing moves
  float r;
};
Capsule MakeCapsule(vec3 a, vec3 b, float r) {
  vec3 m = b - a;
  float mm = dot(m, m);
  return Capsule(a, m, mm > 0.0 ? 1.0 / mm : 0.0, r);
}
float SquaredDistance(Capsule c, vec3 p) {
  vec3 out_of_a = p - c.a, away = out_of_a - clamp(dot(out_of_a, c.m) * c.per_mm2, 0.0, 1.0) * c.m;
  return dot(away, away);
}

// The same exactly.
struct ExactCapsule {
  dvec3 a, m;
  double per_mm2, r;
};
ExactCapsule MakeExactCapsule(dvec3 a, dvec3 b, double r) {
  dvec3 m = b - a;
  double mm = dot(m, m);
  return ExactCapsule(a, m, mm > 0.0lf ? 1.0lf / mm : 0.0lf, r);
}
dvec3 Away(ExactCapsule c, dvec3 p) {
  dvec3 out_of_a = p - c.a;
  return out_of_a - clamp(dot(out_of_a, c.m) * c.per_mm2, 0.0lf, 1.0lf) * c.m;
}
bool Inside(ExactCapsule c, dvec3 p) { return length(Away(c, p)) < c.r; }

// The direction in which a ball gives way whose centre lies on the axis: what rounding has left would count.
dvec3 OnAxis(ExactCapsule c, dvec3 p, dvec3 away, double d) {
  dvec3 u = away;
  double along = dot(p - c.a, c.m) * c.per_mm2;
  if (along > 0.0lf && along < 1.0lf) u -= dot(u, c.m) * c.per_mm2 * c.m;
  dvec3 s = abs(c.m);
  dvec3 pick = s.x <= s.y && s.x <= s.z ? dvec3(1, 0, 0) : s.y <= s.z ? dvec3(0, 1, 0) : dvec3(0, 0, 1);
  double length_of_u = length(u);
  return length_of_u > kOnAxis * d ? u / length_of_u : normalize(pick - dot(pick, c.m) * c.per_mm2 * c.m);
}

bool Swallows(ExactCapsule c, dvec4 ball) { return ball.w + c.r - length(Away(c, ball.xyz)) >= 2.0lf * ball.w; }

dvec4 Shrunk(dvec4 ball, ExactCapsule c) {
  dvec3 away = Away(c, ball.xyz);
  double d = length(away), p = ball.w > 0.0lf ? max(0.0lf, ball.w + c.r - d) : 0.0lf, half_p = 0.5lf * p;
  dvec3 u = away * (1.0lf / max(d, 1e-20lf));
  // a loop, since software drivers execute a branch that nobody takes
  for (uint once = p > 0.0lf && d < kOnAxis * c.r ? 0 : 1; once < 1; ++once) u = OnAxis(c, ball.xyz, away, d);
  bool gone = p > 0.0lf && (p >= 2.0lf * ball.w || ball.w - half_p < kLeastBallRadius);
  return dvec4(ball.xyz + half_p * u, gone ? 0.0lf : ball.w - half_p);
}

// Both pieces of tool ball t's way.
struct Way {
  ExactCapsule slide, give;
};
Way WayOf(uint t, double at_contact, Slide slid_by, dvec3 step_mm) {
  dvec4 contact = ExactAtContact(t, at_contact);
  dvec3 slid = AfterSlide(slid_by, contact.xyz, ExactGoal(t));
  return Way(MakeExactCapsule(contact.xyz, slid, contact.w), MakeExactCapsule(slid, slid + step_mm, contact.w));
}

void RemoveAndClear(uint row) {
  bool go = frame.is_void == 0u && frame.spindle_rad_per_s != 0.0;
  uint end_balls = Takes(row, 0u) && go ? ChunkEnd(frame.live_ball_count) : 0u;
  uint end_points = Takes(row, 2u) && go ? ChunkEnd(frame.live_point_count) : 0u;
  bool reports = Takes(row, 1u) && gl_WorkGroupID.x == 0u;
  // nothing to do: a loop, since software drivers execute a branch that nobody takes
  for (uint once = reports || ChunkBegin() < max(end_balls, end_points) ? 0 : 1; once < 1; ++once) {
    double at_contact = ExactFraction();
    Slide slid_by = ChosenSlide();
    Advance advance = AdvanceOfFrame(at_contact, slid_by);
    if (reports && gl_LocalInvocationID.x == 0u) {
      frame.exact.advance = advance.advance_mm;
      frame.exact.edge_work = advance.edge_work_Nmm;
      frame.exact.step = advance.step_mm;
      frame.turns = slid_by.turns ? 1u : 0u;
      frame.exact.slid_share = slid_by.share;
    }
    float rounding = frame.rounding_mm, travel = float(slid_by.way_mm + length(advance.step_mm)) + rounding;
    // the only cutter's way, where there is but one
    Way only = WayOf(0, at_contact, slid_by, advance.step_mm);
    Capsule slide = MakeCapsule(vec3(only.slide.a), vec3(only.give.a), float(only.slide.r)),
            give = MakeCapsule(vec3(only.give.a), vec3(only.give.a + only.give.m), float(only.slide.r));
    float inner = slide.r - rounding, outer = slide.r + rounding;

    for (uint slot = ChunkBegin(); slot < end_balls; slot += ChunkStep()) {
      vec4 ball = LiveBall(slot), whole = ball;
      float before = ball.w;
      if (kOneCutter) {
        float reach = before + slide.r + rounding;
        float least = min(SquaredDistance(slide, ball.xyz), SquaredDistance(give, ball.xyz));
        for (uint touched = before > 0.0 && least < reach * reach ? 0 : 1; touched < 1; ++touched)
          ball = vec4(Shrunk(Shrunk(dvec4(ball), only.slide), only.give));
      } else {
        dvec4 exact_ball = dvec4(ball);
        Live entry = LiveEntry(slot);
        uint last = before > 0.0 ? entry.first + entry.count : 0u;
        for (uint part = 0; part < 2; ++part)
          for (uint k = entry.first; k < last; ++k) {
            uint t = ToolOfSpan(k);
            vec4 contact = AtContact(t, float(at_contact));
            vec3 away = ball.xyz - contact.xyz;
            float reach = contact.w + ball.w + travel;
            // most of the list is out of reach of this frame's way
            for (uint meets = dot(away, away) < reach * reach ? 0 : 1; meets < 1; ++meets) {
              Way way = WayOf(t, at_contact, slid_by, advance.step_mm);
              if (part == 0u) exact_ball = Shrunk(exact_ball, way.slide);
              else exact_ball = Shrunk(exact_ball, way.give);
              ball = vec4(exact_ball);
            }
          }
      }
      if (kSplit) {
        // a ball that should be split, or a child: loops, since software drivers execute a branch that nobody takes
        uint index = LiveEntry(slot).index;
        bool child = ball.w != before && index >= frame.first_child;
        bool large = ball.w != before && !child && before > frame.split_radius_mm;
        for (uint once = large ? 0 : 1; once < 1; ++once) {
          bool swallowed = false;
          if (kOneCutter) {
            swallowed = Swallows(only.slide, dvec4(whole)) || Swallows(only.give, dvec4(whole));
          } else {
            Live entry = LiveEntry(slot);
            for (uint k = entry.first; k < entry.first + entry.count; ++k) {
              Way way = WayOf(ToolOfSpan(k), at_contact, slid_by, advance.step_mm);
              swallowed = swallowed || Swallows(way.slide, dvec4(whole)) || Swallows(way.give, dvec4(whole));
            }
          }
          if (swallowed) break;
          uint place = atomicAdd(frame.request_count, 1u);
          if (place < frame.request_capacity) requests[place] = SplitRequest(index, whole, ball);
        }
        for (uint once = child ? 0 : 1; once < 1; ++once) {
          uint block = (index - frame.first_child) / kGroupSize;
          if (ball.w < blocks[block].least_mm) ball.w = 0.0;
          if (ball.w == 0.0) atomicAdd(blocks[block].live, 0xffffffffu);
        }
      }
      if (ball.w != before) live_balls[slot] = ball;
    }

    for (uint slot = ChunkBegin(); slot < end_points; slot += ChunkStep()) {
      vec4 point = LivePoint(slot);
      bool inside = false;
      if (kOneCutter) {
        float least = min(SquaredDistance(slide, point.xyz), SquaredDistance(give, point.xyz));
        inside = least < inner * inner;
        for (uint near = !inside && least < outer * outer ? 0 : 1; near < 1; ++near)
          inside = Inside(only.slide, dvec3(point.xyz)) || Inside(only.give, dvec3(point.xyz));
      } else {
        Live entry = PointEntry(slot);
        uint last = point.w > 0.0 ? entry.first + entry.count : 0u;
        for (uint k = entry.first; k < last; ++k) {
          uint t = ToolOfSpan(k);
          vec4 contact = AtContact(t, float(at_contact));
          vec3 away = point.xyz - contact.xyz;
          float reach = contact.w + travel;
          for (uint meets = dot(away, away) < reach * reach ? 0 : 1; meets < 1; ++meets) {
            Way way = WayOf(t, at_contact, slid_by, advance.step_mm);
            inside = inside || Inside(way.slide, dvec3(point.xyz)) || Inside(way.give, dvec3(point.xyz));
          }
        }
      }
      for (uint once = inside && point.w > 0.0 ? 0 : 1; once < 1; ++once) {
        uint i = PointEntry(slot).index;
        uint material = point_states[i];
        live_points[slot].w = -point.w;
        point_states[i] = material | kCleared;
        atomicAdd(frame.exact.removed[material], uint64_t(point_units[i]));
      }
    }
  }
}
