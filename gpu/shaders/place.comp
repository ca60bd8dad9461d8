#version 460
#extension GL_GOOGLE_include_directive : require
// After pass 1, one workgroup: where the tool's balls are at first contact. Everything after it reads this.
#include "common.glsl"

void main() {
  for (uint t = gl_LocalInvocationID.x; t <= frame.tool_count; t += kGroupSize)
    frame.contact[t] = vec4(mix(frame.start[t].xyz, frame.goal[t].xyz, ContactFraction()), frame.start[t].w);
}
