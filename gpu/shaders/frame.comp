#version 460
#extension GL_GOOGLE_include_directive : require
// The frame in one dispatch, with the lists of an earlier one: a GPU takes longer from one dispatch to the next than for what
// most passes do. All workgroups meet between the passes. Vulkan does not promise that they are at work at once, so none waits
// for ever: the first whose patience ends shuts the gate for all of them, before anything was changed, and the host runs the
// passes one by one from then on.
#pragma use_vulkan_memory_model
#define ONE_DISPATCH
#include "common.glsl"
#include "contact.glsl"
#include "near_field.glsl"
#include "solve.glsl"
#include "slide_engage.glsl"
#include "remove_clear.glsl"
#include "report.glsl"

const uint kOpen = 1u, kShut = 2u;

shared uint meeting_word;

// What this workgroup has written to the frame is there for the others, and what they have for this one.
void Exchange() {
  memoryBarrier(gl_ScopeQueueFamily, gl_StorageSemanticsBuffer,
                gl_SemanticsAcquireRelease | gl_SemanticsMakeAvailable | gl_SemanticsMakeVisible);
}

// Whether this workgroup is the last to come; what the others have written before they came can be read from here on.
bool Arrive(uint meeting) {
  Exchange();
  barrier();
  if (gl_LocalInvocationID.x == 0u) meeting_word = atomicAdd(frame.arrived[meeting], 1u) + 1u;
  barrier();
  bool last = meeting_word == gl_NumWorkGroups.x;
  if (last) Exchange();
  barrier();
  return last;
}

// Waits for the last one to open the gate; false where it is shut. The same for all workgroups.
bool Enter(uint meeting, bool last) {
  if (last) Exchange();
  barrier();
  if (gl_LocalInvocationID.x == 0u) {
    uint gate = 0u;
    for (uint spin = 0; spin < kMostSpins && gate == 0u && !last; ++spin) gate = atomicAdd(frame.gates[meeting], 0u);
    if (gate == 0u) {
      uint own = last ? kOpen : kShut, before = atomicCompSwap(frame.gates[meeting], 0u, own);
      gate = before == 0u ? own : before;
    }
    meeting_word = gate;
  }
  barrier();
  bool open = meeting_word == kOpen;
  if (!last) Exchange();
  barrier();
  return open;
}

void main() {
  FindContact(kAllRows);
  bool go = Enter(0u, Arrive(0u));
  if (go) {
    FindNearField(kAllRows);
    bool last = Arrive(1u);
    if (last) Solve();
    go = Enter(1u, last);
  }
  if (go) {
    SlideAndEngage(kAllRows);
    go = Enter(2u, Arrive(2u));
  }
  if (go)
    RemoveAndClear(kAllRows);
  else if (gl_LocalInvocationID.x == 0u)
    frame.gave_up = 1u;
  if (Arrive(3u)) ReportFrame();
}
