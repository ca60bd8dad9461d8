// Pass 3: every cutting ball's capsules (first contact to slid, slid to end of the advance) take their share of each live ball
// (row 0; equation 5, corrected; twin of simulation::ShrinkBall), one invocation a ball, and clear the mass points in them
// (row 2), each once and booked in whole units of volume: the result does not depend on scheduling. The list's copies are the
// balls from here on, until flush.comp writes them back.
#include "rate_law.glsl"

const float kLeastBallRadius = 1e-3;  // mm
const float kOnAxis = 1e-3;           // simulation::kOnAxis

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
vec3 Away(Capsule c, vec3 p) {
  vec3 out_of_a = p - c.a;
  return out_of_a - clamp(dot(out_of_a, c.m) * c.per_mm2, 0.0, 1.0) * c.m;
}
bool Inside(Capsule c, vec3 p) {
  vec3 away = Away(c, p);
  return dot(away, away) < c.r * c.r;
}

// The direction in which a ball gives way whose centre lies on the axis: what rounding has left would count.
vec3 OnAxis(Capsule c, vec3 p, vec3 away, float d) {
  vec3 u = away;
  float along = dot(p - c.a, c.m) * c.per_mm2;
  if (along > 0.0 && along < 1.0) u -= dot(u, c.m) * c.per_mm2 * c.m;
  vec3 s = abs(c.m);
  vec3 pick = s.x <= s.y && s.x <= s.z ? vec3(1, 0, 0) : s.y <= s.z ? vec3(0, 1, 0) : vec3(0, 0, 1);
  return length(u) > kOnAxis * d ? normalize(u) : normalize(pick - dot(pick, c.m) * c.per_mm2 * c.m);
}

bool Swallows(Capsule c, vec4 ball) { return ball.w + c.r - length(Away(c, ball.xyz)) >= 2.0 * ball.w; }

vec4 Shrunk(vec4 ball, Capsule c) {
  vec3 away = Away(c, ball.xyz);
  float d = length(away);
  float p = ball.w > 0.0 ? ball.w + c.r - d : 0.0;
  vec3 u = away * (1.0 / max(d, 1e-20));
  // a loop, since software drivers execute a branch that nobody takes
  for (uint once = p > 0.0 && d < kOnAxis * c.r ? 0 : 1; once < 1; ++once) u = OnAxis(c, ball.xyz, away, d);
  float half_p = 0.5 * max(p, 0.0);
  bool gone = p > 0.0 && (p >= 2.0 * ball.w || ball.w - half_p < kLeastBallRadius);
  return vec4(ball.xyz + half_p * u, gone ? 0.0 : ball.w - half_p);
}

void RemoveAndClear(uint row) {
  bool go = frame.is_void == 0u && frame.spindle_rad_per_s != 0.0;
  uint end_balls = Takes(row, 0u) && go ? ChunkEnd(frame.live_ball_count) : 0u;
  uint end_points = Takes(row, 2u) && go ? ChunkEnd(frame.live_point_count) : 0u;
  bool reports = Takes(row, 1u) && gl_WorkGroupID.x == 0u;
  // nothing to do: a loop, since software drivers execute a branch that nobody takes
  for (uint once = reports || ChunkBegin() < max(end_balls, end_points) ? 0 : 1; once < 1; ++once) {
    float at_contact = ContactFraction();
    Slide slid_by = ChosenSlide();
    Advance advance = AdvanceOfFrame(at_contact, slid_by);
    if (reports && gl_LocalInvocationID.x == 0u) {
      frame.advance_mm = advance.advance_mm;
      frame.edge_work_Nmm = advance.edge_work_Nmm;
      frame.step_mm = vec4(advance.step_mm, 0.0);
      frame.turns = slid_by.turns ? 1u : 0u;
      frame.slid_share = slid_by.share;
    }
    // the only cutter's places, where there is but one
    vec4 only = AtContact(0, at_contact);
    vec3 only_slid = AfterSlide(slid_by, only.xyz, Goal(0)), only_end = only_slid + advance.step_mm;
    float travel = slid_by.way_mm + length(advance.step_mm) + 1e-4;  // of any tool ball at most
    Capsule slide = MakeCapsule(only.xyz, only_slid, only.w), give = MakeCapsule(only_slid, only_end, only.w);

    for (uint slot = ChunkBegin(); slot < end_balls; slot += ChunkStep()) {
      vec4 ball = LiveBall(slot), whole = ball;
      float before = ball.w;
      if (kOneCutter) {
        ball = Shrunk(Shrunk(ball, slide), give);
      } else {
        Live entry = LiveEntry(slot);
        uint last = before > 0.0 ? entry.first + entry.count : 0u;
        for (uint part = 0; part < 2; ++part)
          for (uint k = entry.first; k < last; ++k) {
            uint t = ToolOfSpan(k);
            vec4 contact = AtContact(t, at_contact);
            vec3 away = ball.xyz - contact.xyz;
            float reach = contact.w + ball.w + travel;
            // most of the list is out of reach of this frame's way
            for (uint meets = dot(away, away) < reach * reach ? 0 : 1; meets < 1; ++meets) {
              vec3 slid = AfterSlide(slid_by, contact.xyz, Goal(t));
              ball = Shrunk(ball, MakeCapsule(part == 0 ? contact.xyz : slid,
                                              part == 0 ? slid : slid + advance.step_mm, contact.w));
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
            swallowed = Swallows(slide, whole) || Swallows(give, whole);
          } else {
            Live entry = LiveEntry(slot);
            for (uint k = entry.first; k < entry.first + entry.count; ++k) {
              uint t = ToolOfSpan(k);
              vec4 contact = AtContact(t, at_contact);
              vec3 slid = AfterSlide(slid_by, contact.xyz, Goal(t));
              swallowed = swallowed || Swallows(MakeCapsule(contact.xyz, slid, contact.w), whole) ||
                          Swallows(MakeCapsule(slid, slid + advance.step_mm, contact.w), whole);
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
        inside = Inside(slide, point.xyz) || Inside(give, point.xyz);
      } else {
        Live entry = PointEntry(slot);
        uint last = point.w > 0.0 ? entry.first + entry.count : 0u;
        for (uint k = entry.first; k < last; ++k) {
          uint t = ToolOfSpan(k);
          vec4 contact = AtContact(t, at_contact);
          vec3 away = point.xyz - contact.xyz;
          float reach = contact.w + travel;
          if (dot(away, away) >= reach * reach) continue;
          vec3 slid = AfterSlide(slid_by, contact.xyz, Goal(t));
          inside = inside || Inside(MakeCapsule(contact.xyz, slid, contact.w), point.xyz) ||
                   Inside(MakeCapsule(slid, slid + advance.step_mm, contact.w), point.xyz);
        }
      }
      for (uint once = inside && point.w > 0.0 ? 0 : 1; once < 1; ++once) {
        uint i = PointEntry(slot).index;
        uint material = point_states[i];
        live_points[slot].w = -point.w;
        point_states[i] = material | kCleared;
        atomicAdd(frame.removed[material], point_units[i]);
      }
    }
  }
}
