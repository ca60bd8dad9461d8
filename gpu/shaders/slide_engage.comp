#version 460
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "slide_engage.glsl"

void main() { SlideAndEngage(gl_WorkGroupID.y); }
