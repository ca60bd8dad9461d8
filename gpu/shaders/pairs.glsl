// Pairs of a ball and a tool ball in the lists. A packed pair has the gap when it was measured. The tool has moved by at most
// the displacement since, and bone only shrinks, so pairs that are too far are skipped without reading the balls.

// Displacement of the tool balls of a kind since their packed pairs were measured, at fraction s of the frame's path.
float Displacement(bool cutting, float s) {
  if (frame.lists_at_contact != 0u) return 0.0;  // only steps after first contact use it
  return cutting ? mix(frame.cutting_measured_start_mm, frame.cutting_measured_goal_mm, s)
                 : mix(frame.shaft_measured_start_mm, frame.shaft_measured_goal_mm, s);
}

// Largest packed gap of a pair that may now be nearer than `gap_mm`.
const float kPackedGapRounding_mm = 1e-3;  // many times the rounding of floats
uint PackedGapLimit(float gap_mm) {
  return uint(clamp((gap_mm + kPackedGapRounding_mm) / kPackedGapUnit + 1.0, 0.0, float(kMaxPackedGap)));
}

// Lists of pairs: of listed balls, of balls near tool balls that do not cut, of listed points. With one cutting ball the first
// needs no packed pairs.
const uint kCutting = 0u, kShaft = 1u, kPoint = 2u;
// FirstList and LastList: the range of lists that a workgroup's row takes, among the first two; `shaft_row` takes the second.
uint FirstList(uint row, uint shaft_row) { return kOneCutter || row == shaft_row ? kShaft : kCutting; }
uint LastList(uint row, uint shaft_row) { return row == shaft_row ? kShaft : kCutting; }

// Iterator over the pairs of an invocation's share of a list.
struct Walk {
  uint list;
  uint next, end;  // entries not visited yet
  uint before;  // entries of another list in the same texels
  uint slot;  // slot of the current ball or point
  uint k, last;  // range of the current ball's or point's packed pairs that are not read yet
  uvec4 pairs;  // the four packed pairs before k
  uint left;  // bit i: pair i of `pairs` is still to be visited
  uint pair;  // the current packed pair
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

// Advances to the next pair with a packed gap of at most `farthest`; false at the end. One turn of the loop is an entry or four
// packed pairs. Software drivers continue until all lanes have found a pair, and the pairs are then processed together.
bool NextPair(inout Walk walk, uint farthest) {
  while (walk.left == 0u && (walk.k < walk.last || walk.next < walk.end)) {
    if (walk.k >= walk.last && walk.next < walk.end) {
      uvec4 entry = Entry(walk.list, walk.before + walk.next);
      walk.slot = walk.list == kShaft ? entry.x : walk.next;
      walk.k = entry.y;
      walk.last = walk.list == kPoint || entry.w <= farthest ? entry.y + entry.z : entry.y;
      walk.next += EntryStep();
    }
    walk.pairs = PackedPairsAt(walk.k);
    uint count = min(walk.last - walk.k, 4u);
    bvec4 near = lessThanEqual(walk.pairs >> kToolBits, uvec4(farthest));
    walk.left = ((near.x ? 1u : 0u) | (near.y ? 2u : 0u) | (near.z ? 4u : 0u) | (near.w ? 8u : 0u)) & ((1u << count) - 1u);
    walk.k += count;
  }
  uvec4 pairs = walk.pairs;
  walk.pair = (walk.left & 1u) != 0u ? pairs.x : (walk.left & 2u) != 0u ? pairs.y : (walk.left & 4u) != 0u ? pairs.z : pairs.w;
  bool found = walk.left != 0u;
  walk.left &= walk.left - 1u;
  return found;
}

// Candidates of the float test in an invocation's share of a list, to be tested in double precision after the loop that finds
// them. A processor has room for many, so that all lanes have one to test.
const uint kRoom = kOnGpu ? 1u : 64u;
const uint kMark = 1u << kToolBits;
struct Found {
  uint count;
  uint slot[kRoom], what[kRoom];  // entry or ball; tool ball, with kMark where more has to be tested
} found;
uint InRoom(uint i) { return kRoom == 1u ? 0u : i; }  // a constant index stays in a register
void Note(uint slot, uint t, bool mark) {
  found.slot[InRoom(found.count)] = slot;
  found.what[InRoom(found.count)] = t | (mark ? kMark : 0u);
  ++found.count;
}
bool IsMarked(uint i) { return (found.what[InRoom(i)] & kMark) != 0u; }
// Moves i to the next marked candidate; false where there is none.
bool NextMarked(inout uint i) {
  while (i < found.count && !IsMarked(i)) ++i;
  return i < found.count;
}
