#pragma once

#include <memory>
#include <vector>

#include "base/clock.h"
#include "simulation/surface/tool_sweep.h"

namespace osteon::surface {

/// A stretch of the tool's path, given by the time stamps of the poses of its first and last frame.
struct SweepTimes {
  rt::Nanoseconds begin{0}, end{0};
  friend bool operator==(const SweepTimes&, const SweepTimes&) = default;
};

/// The sweep of a tool in up to ToolSweep::kBatchFrames frames. It never changes, so threads may share it.
struct SweptBatch {
  SweepTimes times;
  bool touches{false};  ///< the tool touched or cut bone in one of the frames
  std::vector<Capsule> capsules;

  /// Whether the batch still counts as swept: no stretch in `undone` overlaps it. A stretch that overlaps
  /// only a part of the batch undoes the whole batch.
  [[nodiscard]] bool Counts(const std::vector<SweepTimes>& undone) const;
};
using SweptBatches = std::vector<std::shared_ptr<const SweptBatch>>;

/// The capsules of the batches that count, in their order.
[[nodiscard]] std::vector<Capsule> CapsulesOf(const SweptBatches& batches,
                                              const std::vector<SweepTimes>& undone);

/// ToolSweep that returns capsules in batches, with the times of their frames, so that a pass can be undone.
/// The tool may be changed; nothing is swept between the last pose of one tool and the first pose of the
/// next.
class BatchedSweep {
 public:
  BatchedSweep(const simulation::Tool& tool, const Pose& X_WG) : X_WG_(X_WG), sweep_(tool, X_WG) {}

  /// Adds a frame, as ToolSweep does. A batch that is complete is appended to `out`.
  void Add(const ToolFrame& frame, SweptBatches& out);
  /// Appends what was swept since the last batch as a batch, if anything was.
  void EndBatch(SweptBatches& out);
  /// Continues with another tool.
  void UseTool(const simulation::Tool& tool, SweptBatches& out);

  /// The path of the tool in use, for a caller that replaces it.
  [[nodiscard]] ToolSweep& sweep() { return sweep_; }
  /// Number of the last frame that was added.
  [[nodiscard]] std::uint64_t frame() const { return sweep_.frame(); }

 private:
  Pose X_WG_;
  ToolSweep sweep_;
  SweptBatch open_;  // the frames since the last batch; times.begin is 0 while none of them cuts
};

}  // namespace osteon::surface
