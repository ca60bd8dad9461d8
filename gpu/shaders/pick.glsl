// Lists of the balls and points that the tool can meet. They are built at the proxy if first contact is then searched in them,
// or at first contact if the whole path to it has been searched. A list's order depends on scheduling; no result depends on it.

// Finds the tool balls of tool_refs[first … end - 1] that come within `reach` of a ball (p, r) at fraction s of the path: counts
// them, then writes their packed pairs.
struct PairRange {
  uint first, count;
  uint min_gap;  // smallest gap of its packed pairs
};
PairRange FindPairRange(uint first, uint end, vec3 p, float r, float reach, float s, bool cut, bool live) {
  PairRange range = PairRange(0u, 0u, 0u);
  if (kOneCutter && cut) {
    vec4 only = AtContact(0, s);
    float far = only.w + r + reach;
    vec3 away = p - only.xyz;
    range.count = live && dot(away, away) <= far * far ? 1u : 0u;
    return range;
  }
  uint lowest = end, highest = first;
  for (uint ref = first; ref < end; ++ref) {
    vec4 ball = AtContact(tool_refs[ref], s);
    float far = ball.w + r + reach;
    vec3 away = p - ball.xyz;
    if (!live || dot(away, away) > far * far) continue;
    lowest = min(lowest, ref);
    highest = ref + 1u;
    ++range.count;
  }
  if (range.count == 0u) return range;
  atomicMax(frame.longest_pair_range, range.count);
  uint room = (range.count + 3u) & ~3u;  // packed pairs are read by four
  uint place = atomicAdd(frame.packed_pair_count, room);
  if (place + room > frame.packed_pair_capacity) {
    frame.list_overflow = 1u;
    return range;
  }
  range.first = place;
  range.min_gap = kMaxPackedGap;
  for (uint ref = lowest; ref < highest; ++ref) {
    uint t = tool_refs[ref];
    vec4 ball = AtContact(t, s);
    float far = ball.w + r + reach;
    vec3 away = p - ball.xyz;
    if (dot(away, away) > far * far) continue;
    uint gap = PackGap(vec4(p, r), ball);
    range.min_gap = min(range.min_gap, gap);
    packed_pairs[place++] = gap << kToolBits | t;
  }
  return range;
}

// Takes the next slot of a list of length `count`, and adds the workgroup that covers it.
#define NEXT_SLOT(slot, count)                             \
  uint slot = atomicAdd(count, 1u);                        \
  if (slot % (kLanes * frame.chunk) == 0u) {               \
    uint groups = min(slot / (kLanes * frame.chunk) + 1u, frame.max_workgroups); \
    atomicMax(frame.pair_work.x, groups);                  \
    atomicMax(frame.all_work.x, groups);                   \
    atomicMax(frame.clear_work.x, groups);                 \
  }

// Fraction of the frame's path at which the lists are built.
float ListFraction() { return frame.lists_at_contact != 0u ? ContactFraction() : 0.0; }
