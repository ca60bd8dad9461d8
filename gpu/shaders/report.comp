#version 460
#extension GL_GOOGLE_include_directive : require
// The frame to where the host reads it, by one workgroup: a copy command takes four times as long on a GPU. The host asks for the
// number and then compares the sum, so the words may arrive in any order.
#include "common.glsl"
shared uint report_sum;

void main() {
  const uint count = kFrameBytes / 16u;
  if (gl_LocalInvocationID.x == 0u) report_sum = 0u;
  barrier();
  uint sum = 0u;
  for (uint i = gl_LocalInvocationID.x; i < count; i += kLanes) {
    uvec4 words = frame_words[i];
    report_words[i] = words;
    sum += words.x + words.y + words.z + words.w;
  }
  sum = subgroupAdd(sum);
  if (subgroupElect()) atomicAdd(report_sum, sum);
  memoryBarrierBuffer();
  barrier();
  if (gl_LocalInvocationID.x == 0u) report_words[count] = uvec4(report_sum, frame.sequence, 0u, 0u);
}
