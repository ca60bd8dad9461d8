#version 460
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "near_field.glsl"

void main() { FindNearField(gl_WorkGroupID.y); }
