#pragma once

#include <span>
#include <string>
#include <string_view>

#include "app/report/scene_sketch.h"

// A scenario of hil/failures as a sketch of what happens: the baseline on the left, ours on the right.
//
//     baseline                      ours
//       ○ frame n                     ○ proxy
//     ══════ sheet                  ══════ sheet
//       ○ next frame                  ◌ the hand's tool
//     what goes wrong               what keeps it from that
//
// Black is what the hand does, orange what the baseline does, blue what ours does; dashed is what is meant,
// or was, but is not.

namespace osteon::app {

/// A scenario's sketch. `draw` is called once for each half.
struct FailureScene {
  int id{0};  ///< FailureScenario::id
  void (*draw)(SceneSketch&){nullptr};
  std::string_view baseline{}, ours{};  ///< below the halves: what goes wrong, and what keeps it from that
};

[[nodiscard]] std::span<const FailureScene> ContactScenes();  ///< the tool against bone that stays as it is
[[nodiscard]] std::span<const FailureScene> CuttingScenes();  ///< bone that is cut
[[nodiscard]] std::span<const FailureScene> ArmScenes();      ///< arm, sensor, hand and wires

/// Both halves with their captions, 820 px wide. @returns one <svg>; empty where no scene has that number.
[[nodiscard]] std::string FailureSceneSvg(int id, const std::string& name);

}  // namespace osteon::app
