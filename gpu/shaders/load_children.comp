#version 460
#extension GL_GOOGLE_include_directive : require
// Before lists are made anew, after flush.comp: what the host has made of balls that are split takes its place.
#include "common.glsl"

void main() {
  for (uint i = gl_GlobalInvocationID.x; i < frame.upload_count; i += gl_NumWorkGroups.x * kLanes) {
    SplitUpload upload = uploads[i];
    if (upload.index < kBallsPerBuffer) balls[upload.index] = upload.ball;
    else more_balls[upload.index - kBallsPerBuffer] = upload.ball;
  }
}
