// Pairs of a ball and a tool ball in the lists. A span's words tell how far each pair was apart where the words were made; the
// tool has moved by no more than the drift since, and bone only shrinks: pairs too far are passed over without a look at them.

// How far a tool ball of the kind is, at fraction s of the frame's way, from where the words were made.
float Drift(bool cutting, float s) {
  if (frame.lists_at_contact != 0u) return 0.0;  // only what comes after first contact asks
  return cutting ? mix(frame.cutting_words_start_mm, frame.cutting_words_goal_mm, s)
                 : mix(frame.shaft_words_start_mm, frame.shaft_words_goal_mm, s);
}

// The largest gap in a word of a pair that may now be nearer than `gap_mm`.
const float kSpanRounding_mm = 1e-3;  // of floats, many times over
uint WordGap(float gap_mm) {
  return uint(clamp((gap_mm + kSpanRounding_mm) / kSpanGapUnit + 1.0, 0.0, float(kLargestSpanGap)));
}

// Lists of pairs: of live balls, of those near balls that do not cut, of live points. With one cutter the first needs no words.
const uint kCutting = 0u, kShaft = 1u, kPoint = 2u;
// Of the first two those that a workgroup takes, of which `shaft_row` are the second's.
uint FirstList(uint row, uint shaft_row) { return kOneCutter || row == shaft_row ? kShaft : kCutting; }
uint LastList(uint row, uint shaft_row) { return row == shaft_row ? kShaft : kCutting; }

// An invocation's way through the pairs of its share of a list.
struct Walk {
  uint list;
  uint next, end;  // entries not looked at yet
  uint before;     // entries of another list in the same texels
  uint slot;       // where the ball or point lies that it is at
  uint k, last;         // its words that were not looked at yet
  uvec4 words;     // those before k
  uint left;       // which of these are still to come
  uint word;       // of the pair it is at
};
uint EntriesBefore(uint list) { return list == kShaft ? frame.live_capacity : 0u; }
Walk BeginWalk(uint list, bool any) {
  uint count = list == kCutting ? frame.live_ball_count : list == kShaft ? frame.shaft_count : frame.live_point_count;
  return Walk(list, FirstEntry(), any ? count : 0u, EntriesBefore(list), 0u, 0u, 0u, uvec4(0u), 0u, 0u);
}
uvec4 Entry(uint list, uint place) {
  if (list == kPoint) return texelFetch(point_entry_texels, int(place));
  return texelFetch(entry_texels, int(place));
}

// On to the next pair whose word tells a gap of `farthest` at most; false at the end. One turn of the loop is an entry or four
// words: software drivers go on until all lanes have found one, and what is then done with the pairs is done for all at once.
bool NextPair(inout Walk walk, uint farthest) {
  while (walk.left == 0u && (walk.k < walk.last || walk.next < walk.end)) {
    if (walk.k >= walk.last && walk.next < walk.end) {
      uvec4 entry = Entry(walk.list, walk.before + walk.next);
      walk.slot = walk.list == kShaft ? entry.x : walk.next;
      walk.k = entry.y;
      walk.last = walk.list == kPoint || entry.w <= farthest ? entry.y + entry.z : entry.y;
      walk.next += EntryStep();
    }
    walk.words = SpanWords(walk.k);
    uint count = min(walk.last - walk.k, 4u);
    bvec4 near = lessThanEqual(walk.words >> kToolBits, uvec4(farthest));
    walk.left = ((near.x ? 1u : 0u) | (near.y ? 2u : 0u) | (near.z ? 4u : 0u) | (near.w ? 8u : 0u)) & ((1u << count) - 1u);
    walk.k += count;
  }
  uvec4 words = walk.words;
  walk.word = (walk.left & 1u) != 0u ? words.x : (walk.left & 2u) != 0u ? words.y : (walk.left & 4u) != 0u ? words.z : words.w;
  bool found = walk.left != 0u;
  walk.left &= walk.left - 1u;
  return found;
}

// What floats have found in an invocation's share of a list, to be looked at exactly behind the loop that finds it. On a processor
// there is room for many, so that all lanes have one to look at.
const uint kRoom = kOnGpu ? 1u : 64u;
const uint kMark = 1u << kToolBits;
struct Found {
  uint count;
  uint slot[kRoom], what[kRoom];  // entry or ball; tool ball, and kMark where more is to be asked
} found;
uint InRoom(uint i) { return kRoom == 1u ? 0u : i; }  // a known place stays in a register
void Note(uint slot, uint t, bool mark) {
  found.slot[InRoom(found.count)] = slot;
  found.what[InRoom(found.count)] = t | (mark ? kMark : 0u);
  ++found.count;
}
bool IsMarked(uint i) { return (found.what[InRoom(i)] & kMark) != 0u; }
// Whether a marked one comes from i on; i is it then.
bool NextMarked(inout uint i) {
  while (i < found.count && !IsMarked(i)) ++i;
  return i < found.count;
}
