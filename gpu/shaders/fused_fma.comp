#version 460
// Computes the rounding error of products by fma(). HasFusedFma (context/fused_fma.cpp) compares it with the exact error.
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x = 64) in;
struct FmaTrial {
  float a, b, found;
};
layout(scalar, binding = 0) buffer Trials { FmaTrial trials[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= trials.length()) return;
  float a = trials[i].a, b = trials[i].b;
  precise float product = a * b;
  precise float rest = fma(a, b, -product);
  trials[i].found = rest;
}
