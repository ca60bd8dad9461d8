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
  /// One of CpuInstructionSets(); empty: the best that this processor has.
  std::string instruction_set{};
  bool brute_force{false};  ///< every pair in every pass: what the neighbour lists are held against
  bool look_ahead{true};    ///< the next list is made in slices while the last one serves
  bool time_stages{false};  ///< fills CpuFrameStats::stage_s
  /// Pairs of a block of eight balls (or points of a material) and a tool ball that may be listed at once:
  /// beyond, a frame is kOverloaded and changes nothing. Six bytes each, twice.
  std::size_t list_capacity{4'000'000};
};

/// The stages of a frame, in their order.
enum class CpuStage : std::uint8_t {
  kPlace,       ///< the tool's balls at the proxy and at the pose
  kLists,       ///< neighbour lists, where they are made
  kContact,     ///< first contact
  kNearField,   ///< nearest pairs of the bins, sums about the faces
  kLaw,         ///< the contact law
  kSlide,       ///< contact on the slide's way
  kEngagement,  ///< engaged area
  kRemoval,     ///< balls
  kClearing,    ///< points
  kFinish,      ///< books and contact model
  kCount
};
[[nodiscard]] const char* NameOf(CpuStage stage);

/// What the last frame did; a frame in parts is told of as a whole.
struct CpuFrameStats {
  bool lists_made{false};       ///< a whole list, at once
  std::size_t ball_rows{0};     ///< pairs of blocks and tool balls that are listed
  std::size_t listed_balls{0};  ///< within reach and skin of the tool, in whole blocks
  std::size_t listed_points{0};
  std::size_t balls_changed{0}, points_cleared{0};
  std::array<double, static_cast<std::size_t>(CpuStage::kCount)> stage_s{};
};

/// Highway's names of the instruction sets that this processor has and this build knows, best first: "N_AVX3"
/// (AVX-512), "N_AVX2", "N_SSE4", and plain C++ last.
[[nodiscard]] std::vector<std::string> CpuInstructionSets();

/// An instruction set as CpuEngine::device says it: "one thread, AVX-512" for "N_AVX3".
[[nodiscard]] std::string CpuDeviceText(const std::string& instruction_set);

/// The cutting model on one thread of the processor: for machines without a GPU.
///
///     proxy, pose ─▶ first contact ─▶ near field ─▶ law ─▶ slide ─▶ engaged area ─▶ removal ─▶ model
///                         ▲ Verlet neighbour lists: blocks of eight balls or points, and tool balls near them
///
/// Every number is the reference engine's (ReferenceEngine), to the last bit, with every instruction set:
/// floats, eight at a time, only exclude what cannot play a part (engine_cpu/rounding.h), and doubles decide
/// by the reference's own functions in its order. So a run may change between the two at any frame. A frame
/// allocates nothing, but where balls wait to be split (SplitParams::blocks_per_frame).
class CpuEngine final : public CuttingEngine {
 public:
  static constexpr std::size_t kMaxToolBalls = 10'000;

  /// @param X_WG  pose of the bone in the world
  /// @throws std::invalid_argument where the bone has more than kMaxMaterials materials, the tool has no ball
  /// or more
  ///   than kMaxToolBalls, params.split is not accepted, or the processor does not have the instruction set.
  CpuEngine(const Bone& bone, const Tool& tool, const Pose& X_WG, const CuttingParams& params,
            const CpuParams& cpu = {});
  ~CpuEngine() override;

  ContactModel Step(const FrameInput& input) override;
  [[nodiscard]] CarvedState Snapshot() const override;
  void Restore(const CarvedState& state) override;
  [[nodiscard]] std::string name() const override { return "cpu"; }
  /// "one thread, AVX-512".
  [[nodiscard]] std::string device() const override;

  [[nodiscard]] const CpuFrameStats& LastFrameStats() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace osteon::simulation
