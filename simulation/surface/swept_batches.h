#pragma once

#include <memory>
#include <vector>

#include "base/clock.h"
#include "simulation/surface/tool_ways.h"

namespace osteon::surface {

/// A stretch of the tool's way: stamps of its frames' poses, both ends in it.
struct WayTimes {
  rt::Nanoseconds begin{0}, end{0};
  friend bool operator==(const WayTimes&, const WayTimes&) = default;
};

/// The sweep of a tool in up to ToolWays::kBatchFrames frames. It never changes, so threads may share it.
struct SweptBatch {
  WayTimes times;
  bool touches{false};  ///< the tool touched or cut bone in one of the frames
  std::vector<Capsule> capsules;

  /// Whether what was swept stays swept. A batch is taken back whole.
  [[nodiscard]] bool Counts(const std::vector<WayTimes>& taken_back) const;
};
using SweptBatches = std::vector<std::shared_ptr<const SweptBatch>>;

/// The capsules of the batches that count, in their order.
[[nodiscard]] std::vector<Capsule> CapsulesOf(const SweptBatches& batches,
                                              const std::vector<WayTimes>& taken_back);

/// ToolWays whose capsules come in batches that know when they were swept, so that a pass can be taken back.
/// The tool may change; nothing is swept between the places of two tools.
class BatchedWays {
 public:
  BatchedWays(const simulation::Tool& tool, const Pose& X_WG) : X_WG_(X_WG), ways_(tool, X_WG) {}

  /// Adds a frame, as ToolWays does. A batch that is complete is appended to `out`.
  void Add(const ToolFrame& frame, SweptBatches& out);
  /// Appends what was swept since the last batch.
  void EndBatch(SweptBatches& out);
  /// Goes on with another tool.
  void UseTool(const simulation::Tool& tool, SweptBatches& out);

  /// The ways of the tool in use, for who replaces them.
  [[nodiscard]] ToolWays& ways() { return ways_; }
  /// Number of the last frame that was added.
  [[nodiscard]] std::uint64_t frame() const { return ways_.frame(); }

 private:
  Pose X_WG_;
  ToolWays ways_;
  SweptBatch open_;  // of the frames since the last batch; times.begin 0: none of them cuts
};

}  // namespace osteon::surface
