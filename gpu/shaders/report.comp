#version 460
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "report.glsl"

void main() { ReportFrame(); }
