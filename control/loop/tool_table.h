#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "base/marker.h"
#include "control/guidance/guidance.h"
#include "control/setup/loop_tool.h"
#include "control/setup/servo_params.h"

namespace osteon::control {

/// The tools between which the loop can change, each with its guidance. If the loop has only the tool of its
/// constructor, the table is empty and the index is 0.
class ToolTable {
 public:
  /// Sets the tools, and the index of the one in use. May allocate.
  /// @param params  of the loop
  /// @throws std::invalid_argument naming the entry and its error; the table is then unchanged
  void Set(std::vector<LoopTool> tools, int index, const ServoParams& params);

  /// Whether `index` is a tool of the table that is not in use.
  [[nodiscard]] bool IsOther(int index) const OSTEON_RT {
    return index >= 0 && index < static_cast<int>(tools_.size()) && index != index_;
  }
  /// Selects another tool. @pre IsOther(index) @returns X_TN, pose of the new tool's frame in the old tool's
  /// frame
  Pose Select(int index) OSTEON_RT;

  [[nodiscard]] const std::vector<LoopTool>& tools() const { return tools_; }
  [[nodiscard]] int index() const OSTEON_RT { return index_; }
  /// The tool in use, and its guidance in its initial state. @pre the table is not empty
  [[nodiscard]] const LoopTool& tool() const OSTEON_RT { return tools_[static_cast<std::size_t>(index_)]; }
  [[nodiscard]] const std::optional<Guidance>& guidance() const OSTEON_RT {
    return guidances_[static_cast<std::size_t>(index_)];
  }

 private:
  std::vector<LoopTool> tools_;
  std::vector<std::optional<Guidance>> guidances_;
  int index_{0};
};

/// @throws std::invalid_argument naming the pose, unless it is a finite position and a rotation.
void RequirePose(const Pose& X, const char* name);

}  // namespace osteon::control
