// Lists of what the tool can meet: at the proxy, where first contact is to be found among them, or at first contact, where
// the whole way there has been searched. A list's order is scheduling's; nothing that is made from it depends on the order.

// The tool balls of one kind that come within `reach` of a ball (p, r) at first contact: counted, then written to a span. Those
// that follow each other without a gap need no span of their own, since the spans begin with 0, 1, 2, …
// `cut`: tool balls that cut, or those that do not.
struct Span {
  uint first, count;
};
Span FindSpan(Item item, vec3 p, float r, float reach, float s, bool cut, bool live) {
  Span span = Span(0u, 0u);
  if (kOneCutter && cut) {
    vec4 only = AtContact(0, s);
    float far = only.w + r + reach;
    vec3 away = p - only.xyz;
    span.count = live && dot(away, away) <= far * far ? 1u : 0u;
    return span;
  }
  uint highest = 0u;
  for (uint round = 0; round < 2; ++round) {
    uint written = 0u;
    uint end = live ? item.first + item.count : 0u;
    for (uint ref = item.first; ref < end; ++ref) {
      uint g = group_refs[ref];
      ToolGroup group = tool_groups[g];
      vec4 bound = AtContact(frame.tool_count + g, s);
      vec3 away = p - bound.xyz;
      float far = bound.w + r + reach;
      bool meets = dot(away, away) <= far * far && (group.first < frame.cutter_count) == cut;
      uint last = meets ? group.first + group.count : 0u;
      for (uint t = group.first; t < last; ++t) {
        vec4 ball = AtContact(t, s);
        away = p - ball.xyz;
        far = ball.w + r + reach;
        if (dot(away, away) > far * far) continue;
        if (round == 0u) {
          if (written == 0u) span.first = t;
          highest = t;
        } else {
          spans[span.first + written] = t;
        }
        ++written;
      }
    }
    if (round == 1u) break;
    span.count = written;
    if (written == 0u || highest - span.first + 1u == written) break;  // none, or without a gap
    uint place = atomicAdd(frame.span_count, written);
    if (place + written > frame.span_capacity) {
      // no room: every tool ball of the kind is looked at, which is slow but gives the same
      span.first = cut ? 0u : frame.cutter_count;
      span.count = cut ? frame.cutter_count : frame.tool_count - frame.cutter_count;
      break;
    }
    span.first = place;
  }
  return span;
}

// One more entry in a list of `count`: its slot, and the workgroups that reach it.
#define NEXT_SLOT(slot, count)                             \
  uint slot = atomicAdd(count, 1u);                        \
  if (slot % (kLanes * kChunk) == 0u) {                \
    atomicMax(frame.pair_work.x, slot / (kLanes * kChunk) + 1u); \
    atomicMax(frame.all_work.x, slot / (kLanes * kChunk) + 1u);  \
  }

// Where on the frame's way the lists are made.
float ListFraction() { return frame.lists_at_contact != 0u ? ContactFraction() : 0.0; }
