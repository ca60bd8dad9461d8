#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 1 again, from first contact to the constrained target. Pairs that overlap by less than the tolerance may overlap up
// to it, or a tool would stick to every ball that stands out of a smooth wall.
#include "common.glsl"
#include "first_contact.glsl"

void main() {
  uint slot = gl_GlobalInvocationID.x;
  if (slot >= frame.live_ball_count) return;
  Active mine = live_balls[slot];
  uint i = mine.index;
  if (frame.slide_bits == 0u) return;
  vec4 ball = balls[i];
  if (ball.w <= 0.0) return;
  float s = 2.0;
  for (uvec2 rest = Tools(mine); Any(rest); rest = WithoutLowest(rest)) {
    uint t = Lowest(rest);
    vec4 tool = frame.contact[t];
    s = min(s, FirstContactFraction(ball.xyz - tool.xyz, frame.target[t].xyz - tool.xyz,
                                    tool.w + ball.w - frame.tolerance_mm));
  }
  if (s < 2.0) atomicMin(frame.slide_bits, floatBitsToUint(s));
}
