#version 460
#extension GL_GOOGLE_include_directive : require
// Pass 1: how far the tool gets on its way from the proxy to the pose asked for. A workgroup a cluster of balls.
// The smallest fraction over all pairs, as bits: floats of one sign order like their bits, so that atomicMin is exact and
// independent of scheduling.
#include "common.glsl"
#include "first_contact.glsl"
#include "tool_mask.glsl"

shared uint first;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (gl_LocalInvocationID.x == 0) first = floatBitsToUint(2.0);
  if (!MaskTool(ball_clusters[gl_WorkGroupID.x], 0, 0.0, false)) return;
  if (i < frame.ball_count && balls[i].w > 0.0) {
    vec4 ball = balls[i];
    float s = 2.0;
    for (uint t = 0; t < frame.tool_count; ++t) {
      if (!InMask(t)) continue;
      vec3 a = frame.start[t].xyz;
      s = min(s, FirstContactFraction(ball.xyz - a, frame.goal[t].xyz - a, frame.start[t].w + ball.w));
    }
    if (s < 2.0) atomicMin(first, floatBitsToUint(s));
  }
  barrier();
  if (gl_LocalInvocationID.x == 0 && first < floatBitsToUint(2.0)) atomicMin(frame.contact_bits, first);
}
