#version 460
#extension GL_GOOGLE_include_directive : require
// Writes the host's children of split balls to the ball buffers, and their blocks, after flush.comp and before lists are rebuilt.
#include "common.glsl"

void main() {
  for (uint i = gl_GlobalInvocationID.x; i < frame.upload_count; i += gl_NumWorkGroups.x * kLanes) {
    SplitUpload upload = uploads[i];
    if (upload.index >= frame.ball_count) blocks[upload.index - frame.ball_count] = Block(upload.ball.x, uint(upload.ball.y));
    else if (upload.index < kBallsPerBuffer) balls[upload.index] = upload.ball;
    else more_balls[upload.index - kBallsPerBuffer] = upload.ball;
  }
}
