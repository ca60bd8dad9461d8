#version 460
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "remove_clear.glsl"

void main() { RemoveAndClear(gl_WorkGroupID.y); }
