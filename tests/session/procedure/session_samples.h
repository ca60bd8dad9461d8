#pragma once

#include "session/procedure/session_file.h"

namespace osteon::session::test {

/// A sample for tests: a session of two passes with the first and the last of three reamers; the second pass
/// was undone.
inline SessionFile SomeSession() {
  SessionFile session{.cell = "demo",
                      .cell_file = "config/cells/demo.yaml",
                      .plan_checksum = "0123456789abcdef",
                      .cell_checksum = "1",
                      .bone_checksum = "2",
                      .scene = "acetabulum",
                      .tool = "reamer",
                      .diameters_mm = {44.0, 46.0, 48.5},
                      .clock = "virtual",
                      .gains = {.law = "admittance",
                                .stiffness_N_per_mm = 20.0,
                                .damping_Ns_per_m = 100.0,
                                .mass_kg = {1.7, 1.7, 1.7},
                                .drag_Ns_per_m = {30.0, 30.0, 30.0}},
                      .segments = {},
                      .passes = {},
                      .cup_X_GT = {}};
  session.segments = {{.tool_index = 0,
                       .recording = "run_1.mcap",
                       .begin = 2'000'000,
                       .end = 4'000'000'000,
                       .begin_state = "",
                       .begin_state_hash = "2",
                       .end_state = "state_1.carved",
                       .end_state_hash = "a"},
                      {.tool_index = 2,
                       .recording = "run_1.mcap",
                       .begin = 4'100'000'000,
                       .end = 0,
                       .begin_state = "state_1.carved",
                       .begin_state_hash = "a",
                       .end_state = "",
                       .end_state_hash = "",
                       .guidance_gain = 0.75}};
  session.passes = {{.number = 1,
                     .segment = 0,
                     .tool_index = 0,
                     .begin = 5,
                     .end = 7,
                     .cutting_s = 0.1 + 0.2,  // 0.30000000000000004: every digit must be read back
                     .removed_mm3 = 12.5,
                     .state = "state_1.carved",
                     .state_hash = "a"},
                    {.number = 2,
                     .segment = 1,
                     .tool_index = 2,
                     .begin = 8,
                     .end = 9,
                     .cutting_s = 1.0,
                     .removed_mm3 = 1.0,
                     .state = "state_2.carved",
                     .state_hash = "b",
                     .undone = true}};
  return session;
}

}  // namespace osteon::session::test
