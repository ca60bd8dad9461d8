#version 460
#extension GL_GOOGLE_include_directive : require
// Lists the balls within reach of the tool at first contact. The list's order is scheduling's; nothing depends on it.
#include "common.glsl"

void main() {
  Active mine = near_balls[gl_WorkGroupID.x];
  uint i = mine.index * kGroupSize + gl_LocalInvocationID.x;
  vec4 ball = i < frame.ball_count ? balls[i] : vec4(0.0);
  uvec2 reached = uvec2(0u);
  for (uvec2 rest = Tools(mine); Any(rest); rest = WithoutLowest(rest)) {
    uint t = Lowest(rest);
    vec4 tool = frame.contact[t];
    float r = tool.w + ball.w + frame.ball_reach_mm + frame.built[t].w;
    vec3 away = tool.xyz - ball.xyz;
    if (dot(away, away) < r * r) reached |= Bit(t);
  }
  if (ball.w <= 0.0 || !Any(reached)) return;
  uint slot = atomicAdd(frame.live_ball_count, 1u);
  if (slot % kGroupSize == 0u) atomicAdd(frame.live_balls.x, 1u);
  Active entry = Active(i, reached.x, reached.y);
  live_balls[slot] = entry;
  if (Any(ShaftTools(entry))) atomicMax(frame.shaft_balls.x, slot / kGroupSize + 1u);
}
