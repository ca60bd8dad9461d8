#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/tools/tool.h"

namespace osteon::simulation {

struct CpuParams {
  /// One of CpuInstructionSets(); empty: the best set that this processor has.
  std::string instruction_set{};
  bool brute_force{false};  ///< examine every pair in every pass, to check the neighbour lists
  bool look_ahead{true};    ///< build the next list in slices, while the present one is in use
  bool time_stages{false};  ///< measure CpuFrameStats::stage_s
  /// Largest number of listed pairs of a block (eight balls, or points of a material) and a tool ball. A
  /// frame that needs more pairs has the status kOverloaded and changes nothing. A pair takes six bytes in
  /// each of two lists.
  std::size_t list_capacity{4'000'000};
};

/// The stages of a frame, in their order.
enum class CpuStage : std::uint8_t {
  kPlace,       ///< placing the tool's balls at the proxy and at the tool's pose
  kLists,       ///< building neighbour lists, if needed
  kContact,     ///< search for first contact
  kNearField,   ///< nearest pair of each bin, sums over the faces' cones
  kLaw,         ///< solving the contact law
  kSlide,       ///< search for contact along the slide
  kEngagement,  ///< measuring the engaged area
  kRemoval,     ///< shrinking or splitting balls
  kClearing,    ///< clearing mass points
  kFinish,      ///< totals and contact model
  kCount
};
[[nodiscard]] const char* NameOf(CpuStage stage);

/// Statistics of the last frame; sums over the parts of a frame (StepInParts).
struct CpuFrameStats {
  bool lists_made{false};       ///< a whole list was built in this frame
  std::size_t ball_rows{0};     ///< number of listed pairs of block and tool ball
  std::size_t listed_balls{0};  ///< number of balls in the listed blocks
  std::size_t listed_points{0};
  std::size_t balls_changed{0}, points_cleared{0};
  std::array<double, static_cast<std::size_t>(CpuStage::kCount)> stage_s{};
};

/// Highway's names of the instruction sets that this processor has and this build knows, best first: "N_AVX3"
/// (AVX-512), "N_AVX2", "N_SSE4", and plain C++ last.
[[nodiscard]] std::vector<std::string> CpuInstructionSets();

/// Makes the text of CpuEngine::device for an instruction set: "one thread, AVX-512" for "N_AVX3".
[[nodiscard]] std::string CpuDeviceText(const std::string& instruction_set);

/// The cutting model on one thread of the processor: for machines without a GPU.
///
///     proxy, pose ─▶ first contact ─▶ near field ─▶ law ─▶ slide ─▶ engaged area ─▶ removal ─▶ model
///                         ▲ Verlet neighbour lists: blocks of eight balls or points, and near tool balls
///
/// All results equal those of ReferenceEngine to the last bit, with every instruction set. Computations in
/// floats, eight at a time, only exclude pairs that cannot change the result (engine_cpu/rounding.h). The
/// remaining pairs are computed in double precision by the formulas of the reference engine, in the same
/// order. So a run may switch between the two engines at any frame. A frame allocates no memory, unless balls
/// wait to be split (SplitParams::blocks_per_frame).
class CpuEngine final : public CuttingEngine {
 public:
  static constexpr std::size_t kMaxToolBalls = 10'000;

  /// @param X_WG  pose of the bone in the world
  /// @throws std::invalid_argument if the bone has more than kMaxMaterials materials, the tool has no ball
  ///   or more than kMaxToolBalls, params.split is not accepted, or the processor does not have the
  ///   instruction set.
  CpuEngine(const Bone& bone, const Tool& tool, const Pose& X_WG, const CuttingParams& params,
            const CpuParams& cpu = {});
  ~CpuEngine() override;

  ContactModel Step(const FrameInput& input) override;
  [[nodiscard]] CarvedState Snapshot() const override;
  void Restore(const CarvedState& state) override;
  [[nodiscard]] std::string name() const override { return "cpu"; }
  /// Names the instruction set: "one thread, AVX-512".
  [[nodiscard]] std::string device() const override;

  [[nodiscard]] const CpuFrameStats& LastFrameStats() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace osteon::simulation
