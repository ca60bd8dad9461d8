#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 1: how far the tool gets on its way from the proxy to the pose asked for. A workgroup a cluster of balls.
// The smallest fraction over all pairs, as bits: floats of one sign order like their bits, so that atomicMin is exact and
// independent of scheduling.
#include "common.glsl"
#include "first_contact.glsl"

void main() {
  Active mine = path_balls[gl_WorkGroupID.x];
  uint i = mine.index * kGroupSize + gl_LocalInvocationID.x;
  if (frame.contact_bits == 0u || i >= frame.ball_count) return;  // nothing is earlier than at once
  vec4 ball = balls[i];
  if (ball.w <= 0.0) return;
  float s = 2.0;
  for (uvec2 rest = Tools(mine); Any(rest); rest = WithoutLowest(rest)) {
    uint t = Lowest(rest);
    vec3 a = frame.start[t].xyz;
    s = min(s, FirstContactFraction(ball.xyz - a, frame.goal[t].xyz - a, frame.start[t].w + ball.w));
  }
  if (s < 2.0) atomicMin(frame.contact_bits, floatBitsToUint(s));
}
