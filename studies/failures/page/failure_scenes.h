#pragma once

#include <span>
#include <string>
#include <string_view>

#include "studies/failures/page/scene_sketch.h"

// A scenario of studies/failures as a sketch of what happens: the baseline on the left, ours on the right.
//
//     baseline                      ours
//       ○ frame n                     ○ proxy
//     ══════ sheet                  ══════ sheet
//       ○ next frame                  ◌ the hand's tool
//     what goes wrong               what prevents it
//
// Black is the hand, orange the baseline, blue our method; dashed lines show intended or earlier positions.

namespace osteon::studies {

/// The sketch of a scenario. `draw` is called once for each half.
struct FailureScene {
  int id{0};  ///< number of the scenario, as in FailureScenario::id
  void (*draw)(SceneSketch&){nullptr};
  /// Captions below the halves: what goes wrong with the baseline, and what prevents it in ours.
  std::string_view baseline{}, ours{};
};

[[nodiscard]] std::span<const FailureScene> ContactScenes();   ///< the tool against bone that does not change
[[nodiscard]] std::span<const FailureScene> CuttingScenes();   ///< bone that is cut
[[nodiscard]] std::span<const FailureScene> GuidanceScenes();  ///< guidance along a surgical plan
[[nodiscard]] std::span<const FailureScene> ArmScenes();       ///< arm, sensor, hand and connections
[[nodiscard]] std::span<const FailureScene> PlanScenes();      ///< a surgical plan and its assessment
[[nodiscard]] std::span<const FailureScene> ComplianceScenes();  ///< compliant tool, tissue and mount
[[nodiscard]] std::span<const FailureScene> SequenceScenes();    ///< change of tool, undo, resume

/// Draws both halves with their captions, 820 px wide. @returns one <svg>; empty if no scene has that number.
[[nodiscard]] std::string FailureSceneSvg(int id, const std::string& name);

}  // namespace osteon::studies
