// Which tool balls can reach this workgroup's cluster: most clusters end here.

shared uint tool_mask[2];

bool InMask(uint t) { return (tool_mask[t >> 5] & (1u << (t & 31u))) != 0u; }

// Fills the mask; false where no tool ball reaches the box. `at`: 0 start to goal, 1 contact to target, 2 contact alone,
// 3 contact to end.
vec3 PathStart(uint at, uint t) { return at == 0 ? frame.start[t].xyz : AtContact(t); }
vec3 PathEnd(uint at, uint t) {
  return at == 0 ? frame.goal[t].xyz : at == 1 ? AtTarget(t) : at == 2 ? AtContact(t) : AtEnd(t);
}
bool MaskTool(Cluster box, uint at, float margin, bool cutting_only) {
  uint t = gl_LocalInvocationID.x;
  if (t < 2) tool_mask[t] = 0;
  barrier();
  if (t < frame.tool_count && (!cutting_only || frame.goal[t].w > 0.5) &&
      PathMeetsBox(box, PathStart(at, t), PathEnd(at, t), frame.start[t].w + margin)) {
    atomicOr(tool_mask[t >> 5], 1u << (t & 31u));
  }
  barrier();
  return (tool_mask[0] | tool_mask[1]) != 0u;
}
