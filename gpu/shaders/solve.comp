#version 460
#extension GL_GOOGLE_include_directive : require
// The second half of pass 2 on a processor; on a GPU the last workgroup of near_field.comp runs it.
#include "common.glsl"
#include "solve.glsl"

void main() { Solve(); }
