#pragma once

#include "simulation/engine/cutting_engine.h"
#include "simulation/tools/tool.h"

namespace osteon::studies {

/// A rigid plane instead of bone, for scenarios that test only the control: its contact can be computed by
/// hand, and it takes no time.
///
/// The plane touches the tool's ball that is deepest in it, at that ball's deepest point:
///
///     gap = n·(c_W - p_W) - r      F = k max(0, -gap) n, at c_W - r n
///
/// with a point p_W and the unit normal n of the plane, the ball's centre c_W and radius r, and the stiffness
/// k. F has no bound here: the loop limits it. The proxy is the tool, lifted by max(0, -gap) along n. The
/// plane is reported while its gap is within the parameters' normal_enlargement, as with any engine. Nothing
/// is cut, even if the tool rotates.
class PlaneEngine final : public simulation::CuttingEngine {
 public:
  /// @param p_W  a point of the plane  @param n_W  unit, toward the tool's side
  /// @throws std::invalid_argument if the tool has no ball or n_W is not a unit vector.
  PlaneEngine(simulation::Tool tool, const Vector3& p_W, const Vector3& n_W,
              const simulation::CuttingParams& params);

  simulation::ContactModel Step(const simulation::FrameInput& input) override;
  /// Returns a state that holds only the number of frames: a frame changes nothing else.
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

}  // namespace osteon::studies
