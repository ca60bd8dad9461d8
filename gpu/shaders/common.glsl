// Bindings and helpers that every pass uses.
#extension GL_EXT_scalar_block_layout : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_vote : require
#ifndef OSTEON_NO_INT64
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#endif
#include "layout.h"
#include "bin_key.h"
#ifdef OSTEON_NO_FLOAT64
#include "double_single.glsl"
#endif
#include "words.glsl"

// A processor gets few lanes and long chunks, because it reads shared values once per eight lanes. A GPU gets many lanes
// with one entry each.
layout(local_size_x_id = 3) in;
layout(constant_id = 3) const uint kLanes = 64;
layout(constant_id = 1) const bool kOneCutter = false;  // only tool ball 0 cuts: its list needs no packed pairs
layout(constant_id = 4) const bool kSplit = false;      // large balls are split
layout(constant_id = 5) const bool kContactSphere = false;  // only the tool ball that touches first cuts
layout(constant_id = 6) const uint kMaterials = kMaxMaterials;
layout(constant_id = 7) const bool kOnGpu = false;
layout(constant_id = 8) const uint kToolRemainder = 2;  // index of the first remainder (double minus float) among the tool's texels
layout(constant_id = 9) const uint kBoneBits = kMinBoneBits;  // bits of a bone ball's index in a key

layout(scalar, binding = kBindFrame) buffer FrameBuffer { Frame frame; };
layout(scalar, binding = kBindFrame) coherent buffer FreshFrameBuffer { Frame fresh; };  // for reading values that other workgroups wrote in this pass
layout(scalar, binding = kBindFrame) coherent readonly buffer FrameWordBuffer { uvec4 frame_words[]; };
layout(scalar, binding = kBindFrame) readonly buffer FrameHalfBuffer { uint frame_halves[]; };
layout(scalar, binding = kBindReadback) buffer ReadbackBuffer { uvec4 readback_words[]; };
layout(scalar, binding = kBindClusterPairs) readonly buffer ClusterPairsBuffer { ClusterPairs cluster_pairs[]; };
layout(scalar, binding = kBindToolRefs) readonly buffer ToolRefBuffer { uint tool_refs[]; };
layout(scalar, binding = kBindBalls) buffer BallBuffer { vec4 balls[]; };
layout(scalar, binding = kBindMoreBalls) buffer MoreBallBuffer { vec4 more_balls[]; };
layout(scalar, binding = kBindPoints) readonly buffer PointBuffer { vec4 points[]; };
layout(scalar, binding = kBindPointStates) buffer PointStateBuffer { uint point_states[]; };
layout(scalar, binding = kBindPointUnits) readonly buffer PointUnitBuffer { uint point_units[]; };
layout(scalar, binding = kBindLiveBalls) buffer LiveBallBuffer { vec4 live_balls[]; };
layout(scalar, binding = kBindLiveEntries) buffer LiveEntryBuffer { ListEntry live_entries[]; };
layout(scalar, binding = kBindLivePoints) buffer LivePointBuffer { vec4 live_points[]; };
layout(scalar, binding = kBindPointEntries) buffer PointEntryBuffer { ListEntry point_entries[]; };
layout(scalar, binding = kBindSlots) buffer SlotBuffer { uint slots[]; };
layout(scalar, binding = kBindSplitEvents) writeonly buffer SplitEventBuffer { SplitEvent split_events[]; };
layout(scalar, binding = kBindUploads) readonly buffer UploadBuffer { SplitUpload uploads[]; };
layout(scalar, binding = kBindBlocks) buffer BlockBuffer { Block blocks[]; };
layout(binding = kBindBallTexels) uniform samplerBuffer ball_texels;
layout(binding = kBindPointTexels) uniform samplerBuffer point_texels;
layout(binding = kBindToolTexels) uniform samplerBuffer tool_texels;
layout(binding = kBindPackedPairTexels) uniform usamplerBuffer packed_pair_texels;
layout(binding = kBindEntryTexels) uniform usamplerBuffer entry_texels;
layout(binding = kBindPointEntryTexels) uniform usamplerBuffer point_entry_texels;
layout(scalar, binding = kBindPackedPairs) buffer PackedPairBuffer { uint packed_pairs[]; };

// Adds an integer of each invocation of the subgroup to a sum. All its invocations must call it.
#define ADD_TO(sum, whole)                              \
  {                                                     \
    int high_part = subgroupAdd((whole) >> 16);         \
    int low_part = subgroupAdd((whole) & 0xffff);       \
    if (subgroupElect() && (high_part | low_part) != 0) { \
      atomicAdd(sum.high, high_part);                   \
      atomicAdd(sum.low, uint(low_part));               \
    }                                                   \
  }

// Adds an integer of each invocation of the subgroup, at most 2^62 together. All its invocations must call it.
#define ADD_FINE(sum, whole)                                                                                 \
  {                                                                                                          \
    Sum64 own = (whole);                                                                                     \
    int low_part = subgroupAdd(BitsFrom(own, 0u) & 0xffffff);                                                \
    int middle_part = subgroupAdd(BitsFrom(own, 24u) & 0xffffff);                                            \
    int high_part = subgroupAdd(BitsFrom(own, 48u));                                                         \
    Sum64 all = Plus(Plus(Shifted(low_part, 0u), Shifted(middle_part, 24u)), Shifted(high_part, 48u));       \
    if (subgroupElect() && all != kNoSum) ADD_SUM(sum, all)                                                  \
  }

// Adds an integer of each invocation, at most 2^49 each, for a workgroup on a GPU: stores each subgroup's share, and
// GroupTotal adds the shares up after a barrier.
const uint kMaxSums = 16u;
shared Sum64 group_share[kMaxSums][64];
#define SHARE(place, whole)                                                                                            \
  {                                                                                                                    \
    Sum64 own = (whole);                                                                                               \
    int low_part = subgroupAdd(BitsFrom(own, 0u) & 0x1ffffff);                                                         \
    int high_part = subgroupAdd(BitsFrom(own, 25u));                                                                   \
    if (subgroupElect()) group_share[place][gl_SubgroupID] = Plus(Shifted(low_part, 0u), Shifted(high_part, 25u));     \
  }
Sum64 GroupTotal(uint place) {
  Sum64 total = kNoSum;
  for (uint k = 0u; k < gl_NumSubgroups; ++k) total = Plus(total, group_share[place][k]);
  return total;
}

// True in the last workgroup of the pass to arrive here; it can read the other workgroups' results through `fresh`. All its
// invocations must call it. A GPU saves 2 us for each dispatch that this replaces.
shared bool is_last_group;
bool IsLastGroup() {
  groupMemoryBarrier();
  barrier();
  if (gl_LocalInvocationIndex == 0u) {
    memoryBarrierBuffer();
    is_last_group = atomicAdd(frame.groups_done, 1u) + 1u == gl_NumWorkGroups.x * gl_NumWorkGroups.y;
    if (is_last_group) fresh.groups_done = 0u;  // reset for the next such pass
  }
  barrier();
  if (is_last_group) memoryBarrierBuffer();
  return is_last_group;
}

// The unit vector along v; zero for zero, like Eigen's normalized().
dvec3 Unit(dvec3 v) {
  double squared = dot(v, v);
  return squared > 0.0lf ? (1.0lf / sqrt(squared)) * v : dvec3(0.0lf);
}

// Rank of this invocation among the active ones of its subgroup, and their number: a driver may dispatch fewer than
// gl_SubgroupSize. All invocations of a subgroup must call both.
uint SubgroupRank() { return subgroupBallotExclusiveBitCount(subgroupBallot(true)); }
uint SubgroupWorkers() { return subgroupBallotBitCount(subgroupBallot(true)); }

#include "exact.glsl"
float ContactFraction() { return float(ExactFraction()); }

// True where the frame is void: at first contact the tool is too far from where the lists were built (the host then runs the
// frame again with new lists), or the lists are too short.
bool NeedsRebuild() {
  // Load before branching: && and || serialise the loads.
  float s = ContactFraction();
  vec2 start = vec2(frame.cutting_displacement_start_mm, frame.shaft_displacement_start_mm),
       goal = vec2(frame.cutting_displacement_goal_mm, frame.shaft_displacement_goal_mm),
       skin = vec2(frame.cutting_skin_mm, frame.shaft_skin_mm);
  uint at_contact = frame.lists_at_contact, list_overflow = frame.list_overflow;
  bool far = any(greaterThan(mix(start, goal, s), skin));
  return (at_contact == 0u && far) || list_overflow != 0u;
}

// A pass has rows of workgroups, one for each list; invocations go through a list's entries in strides. A software driver gives
// each of its threads one block of workgroups, so rows are interleaved: each thread gets a share of every row and of the work
// near the tool.
uint GroupNumber() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }
uint Row() { return GroupNumber() % gl_NumWorkGroups.y; }
// This invocation's share of a list: for (uint slot = FirstEntry(); slot < count; slot += EntryStep())
uint FirstEntry() { return GroupNumber() / gl_NumWorkGroups.y * kLanes + gl_LocalInvocationID.x; }
uint EntryStep() { return gl_NumWorkGroups.x * kLanes; }

// Tool ball t: centre at the proxy (w: radius) and at the tool's pose.
vec4 Start(uint t) { return texelFetch(tool_texels, int(2u * t)); }
vec3 Goal(uint t) { return texelFetch(tool_texels, int(2u * t + 1u)).xyz; }
uvec4 PackedPairsAt(uint k) { return texelFetch(packed_pair_texels, int(k / 4u)); }  // the four packed pairs from k on, a multiple of 4
uint PackedPairAt(uint k) { return PackedPairsAt(k)[k % 4u]; }
// Gap between a ball and a tool ball in units of a packed pair, rounded down.
uint PackGap(vec4 ball, vec4 at) {
  return uint(clamp((distance(ball.xyz, at.xyz) - at.w - ball.w) / kPackedGapUnit, 0.0, float(kMaxPackedGap)));
}
uint ToolOf(uint pair) { return pair & ((1u << kToolBits) - 1u); }
vec4 AtContact(uint t, float s) {
  vec4 start = Start(t);
  return vec4(mix(start.xyz, Goal(t), s), start.w);
}
vec4 LiveBall(uint slot) { return texelFetch(ball_texels, int(slot)); }
ListEntry AsListEntry(uvec4 words) { return ListEntry(words.x, words.y, words.z, words.w); }
ListEntry LiveEntry(uint slot) { return AsListEntry(texelFetch(entry_texels, int(slot))); }
ListEntry PointEntry(uint slot) { return AsListEntry(texelFetch(point_entry_texels, int(slot))); }
vec4 LivePoint(uint slot) { return texelFetch(point_texels, int(slot)); }

vec4 BallAt(uint i) {
  vec4 ball = vec4(0.0);
  if (i < kBallsPerBuffer) ball = balls[i];
  else ball = more_balls[i - kBallsPerBuffer];
  return ball;
}
