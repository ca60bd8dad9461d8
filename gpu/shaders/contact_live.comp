#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 1 over the live balls of the frames before: while the tool stays near where their list was made, first contact is
// with one of them.
#include "common.glsl"
#include "first_contact.glsl"

void main() {
  uint slot = gl_GlobalInvocationID.x;
  if (slot >= frame.live_ball_count) return;
  Active mine = live_balls[slot];
  vec4 ball = balls[mine.index];
  if (ball.w <= 0.0) return;
  float s = 2.0;
  for (uvec2 rest = Tools(mine); Any(rest); rest = WithoutLowest(rest)) {
    uint t = Lowest(rest);
    vec4 start = frame.start[t];
    s = min(s, FirstContactFraction(ball.xyz - start.xyz, frame.goal[t].xyz - start.xyz, start.w + ball.w));
  }
  if (s < 2.0) atomicMin(frame.contact_bits, floatBitsToUint(s));
}
