#pragma once

#include "simulation/cutting_engine.h"
#include "simulation/tool.h"

namespace osteon::hil {

/// A rigid plane in place of bone: what it says of a pose can be worked out by hand, and takes no time. For
/// scenarios that look at control alone.
///
/// The plane touches the tool's ball that is deepest in it, at that ball's deepest point:
///
///     gap = n·(c_W - p_W) - r      F = k max(0, -gap) n, at c_W - r n;   no bound: limits are the loop's
///
/// The proxy is the tool, lifted by max(0, -gap) along n. It is reported up to the parameters'
/// normal_enlargement, as any engine's planes are. Nothing is cut, whatever turns.
class PlaneEngine final : public simulation::CuttingEngine {
 public:
  /// @param p_W  a point of the plane  @param n_W  unit, toward the tool's side
  /// @throws std::invalid_argument where the tool has no ball or n_W is no unit vector.
  PlaneEngine(simulation::Tool tool, const Vector3& p_W, const Vector3& n_W,
              const simulation::CuttingParams& params);

  simulation::ContactModel Step(const simulation::FrameInput& input) override;
  /// The count of frames: there is nothing else that a frame changes.
  [[nodiscard]] simulation::CarvedState Snapshot() const override;
  void Restore(const simulation::CarvedState& state) override { frame_ = state.frame; }
  [[nodiscard]] std::string name() const override { return "plane"; }
  [[nodiscard]] std::string device() const override { return "CPU, one rigid plane"; }

 private:
  simulation::Tool tool_;
  Vector3 p_W_, n_W_;
  simulation::CuttingParams params_;
  std::uint64_t frame_{0};
};

}  // namespace osteon::hil
