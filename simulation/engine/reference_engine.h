#pragma once

#include <span>
#include <vector>

#include "simulation/contact/contact_law.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/engine/frame_solution.h"
#include "simulation/engine/tool_reach.h"
#include "simulation/removal/ball_removal.h"

namespace osteon::simulation {

/// The oracle: the cutting model in double precision by plain loops over every pair. Every other engine must
/// reproduce its passes (P: proxy, T: tool's pose):
///
///     1  first contact    P ──▶ T, every tool ball against every bone ball
///     2  normals, slide   lens-weighted planes around the tool there, then the closest target that
///                         keeps them all; first contact again, from there to that target
///     3  advance, removal by energy balance; every cutting ball's capsule, then the mass points in it
///
/// Sources: Kaluschke et al. 2019 (passes 1 to 3), Zilles and Salisbury 1995 (god-object on several planes).
class ReferenceEngine final : public CuttingEngine {
 public:
  /// The balls and points over which the loops run. The result is the same to the last bit.
  enum class Loops {
    kNear,  ///< those that the tool can meet in this frame (ToolReach)
    kAll    ///< every ball and point of the bone
  };

  /// @param X_WG  pose of the bone in the world
  /// @throws std::invalid_argument if the bone has more than kMaxMaterials materials, the tool has no
  ///   ball, or params.split is not accepted.
  ReferenceEngine(const Bone& bone, const Tool& tool, const Pose& X_WG, const CuttingParams& params,
                  Loops loops = Loops::kNear);

  ContactModel Step(const FrameInput& input) override;
  [[nodiscard]] CarvedState Snapshot() const override;
  void Restore(const CarvedState& state) override;
  [[nodiscard]] std::string name() const override { return "reference"; }
  [[nodiscard]] std::string device() const override { return "CPU, double precision"; }

 private:
  ContactModel StepPart(const FrameInput& input);
  void FindNear(const ToolPoints& from, const ToolPoints& to, double farther_m, ToolReach& near) const;
  double FirstContact(const ToolReach& near, const ToolPoints& from, const ToolPoints& to,
                      double tolerance_m) const;
  /// The part of a straight path that contacts and max_slide_m allow.
  struct Slid {
    double fraction, way_m;  ///< fraction of the path; way_m: path length of the point that moves farthest
    bool stopped;            ///< a ball stopped the slide
  };
  Slid Slide(const ToolPoints& from, const ToolPoints& to, double tolerance_m, double max_m) const;
  NearField FindNearField(const ToolPoints& at, const ToolPoints& goal, const Matrix3& R_GT) const;
  void MeasureEngagement(const ToolPoints& at, const Vector3& spindle_axis_G, FrameSolution& solution) const;
  [[nodiscard]] std::size_t FirstTouchingBall(const ToolPoints& from, const ToolPoints& to,
                                              double first) const;
  /// The volumes that a frame's cutting balls sweep.
  struct Swept {
    std::vector<Capsule> capsules;
    std::vector<std::size_t> first;  ///< each tool ball's first capsule; last entry: number of capsules
    [[nodiscard]] std::span<const Capsule> Of(std::size_t t) const {
      return std::span(capsules).subspan(first[t], first[t + 1] - first[t]);
    }
  };
  [[nodiscard]] Swept SweptBy(const ToolPoints& contact, const ToolPoints& slid, const ToolPoints& end,
                              std::size_t only) const;
  void Remove(const Swept& swept, FrameSolution& solution);

  Tool tool_;
  double lever_m_;  ///< lever of the tool (ToolLever)
  std::vector<Material> materials_;
  MaterialMap map_;
  std::vector<MassPoint> points_;
  Pose X_WG_;
  CuttingParams params_;
  std::vector<BallState> balls_;  ///< the packing's balls, then the children of split balls
  BallRemoval removal_;
  std::vector<std::uint8_t> cleared_;
  FrameMemory memory_;
  const Loops loops_;
  ToolReach on_way_;  ///< bone that the tool can meet between proxy and tool pose
  ToolReach near_;    ///< bone around the tool at first contact
};

}  // namespace osteon::simulation
