#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 3, second half: every cutting ball's capsules take their share of each bone ball (equation 5, corrected; twin of
// simulation::ShrinkBall), one invocation a ball: the result does not depend on scheduling.
#include "common.glsl"

const float kLeastBallRadius = 1e-3;  // mm
const float kOnAxis = 1e-3;           // simulation::kOnAxis

void Shrink(inout vec4 ball, vec3 a, vec3 b, float r_t) {
  vec3 away = ball.xyz - ClosestOnSegment(ball.xyz, a, b);
  float d = length(away);
  float p = ball.w + r_t - d;
  if (ball.w <= 0.0 || p <= 0.0) return;
  if (p >= 2.0 * ball.w || ball.w - 0.5 * p < kLeastBallRadius) {
    ball.w = 0.0;
    return;
  }
  vec3 u = away, m = b - a;
  float mm = dot(m, m), along = dot(ball.xyz - a, m);
  if (d < kOnAxis * r_t && along > 0.0 && along < mm) u -= dot(u, m) / mm * m;
  if (length(u) > kOnAxis * d) {
    u = normalize(u);
  } else {
    vec3 s = abs(m);
    vec3 pick = s.x <= s.y && s.x <= s.z ? vec3(1, 0, 0) : s.y <= s.z ? vec3(0, 1, 0) : vec3(0, 0, 1);
    u = normalize(mm > 0.0 ? pick - dot(pick, m) / mm * m : pick);
  }
  ball.xyz += 0.5 * p * u;
  ball.w -= 0.5 * p;
}

void main() {
  uint slot = gl_GlobalInvocationID.x;
  if (slot >= frame.live_ball_count) return;
  Active mine = live_balls[slot];
  uint i = mine.index;
  if (frame.spindle_rad_per_s == 0.0) return;
  vec4 ball = balls[i];
  float before = ball.w;
  if (before <= 0.0) return;
  for (uint part = 0; part < 2; ++part)
    for (uvec2 rest = CuttingTools(mine); Any(rest); rest = WithoutLowest(rest)) {
      uint t = Lowest(rest);
      vec4 slid = frame.slid[t];
      Shrink(ball, part == 0 ? frame.contact[t].xyz : slid.xyz, part == 0 ? slid.xyz : frame.end[t].xyz, slid.w);
    }
  if (ball.w == 0.0) atomicAdd(ball_clusters[i / kGroupSize].alive, 0xffffffffu);
  if (ball.w != before) balls[i] = ball;
}
