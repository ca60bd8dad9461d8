#version 460
#extension GL_GOOGLE_include_directive : require
// Writes the list's copies of the balls back to the ball buffers, before lists are rebuilt or the state is read.
#include "common.glsl"

void main() {
  uint end = frame.flush_count;
  for (uint slot = FirstEntry(); slot < end; slot += EntryStep()) {
    uint i = LiveEntry(slot).index;
    if (i < kBallsPerBuffer) balls[i] = live_balls[slot];
    else more_balls[i - kBallsPerBuffer] = live_balls[slot];
  }
}
