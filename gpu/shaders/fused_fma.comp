#version 460
// The rest that fma() leaves of a product beyond its rounding: context/fused_fma.h compares it with the exact one.
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
