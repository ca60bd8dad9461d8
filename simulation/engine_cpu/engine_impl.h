#pragma once

// Private to engine_cpu: the class that the engine's sources share. engine_frame.cpp computes a frame,
// engine_passes.cpp calls the kernels, and cpu_engine.cpp implements the public interface.

#include <chrono>
#include <optional>

#include "simulation/contact/contact_law.h"
#include "simulation/engine/frame_solution.h"
#include "simulation/engine_cpu/cpu_engine.h"
#include "simulation/engine_cpu/list_keeper.h"

namespace osteon::simulation {

struct CpuEngine::Impl {
  Impl(const Bone& bone, const Tool& tool_in, const Pose& X_WG_in, const CuttingParams& params_in,
       const CpuParams& cpu_in);

  // ---- constant after construction
  Tool tool;
  double lever_m;
  std::vector<Material> materials;
  MaterialMap map;
  Pose X_WG;
  CuttingParams params;
  CpuParams cpu;
  const cpu::Kernels& kernels;

  // ---- state that a frame changes
  cpu::BoneStore bone;
  cpu::ToolBalls balls;
  std::optional<cpu::SplitBlocks> split;
  cpu::ClusterSearch search;
  cpu::ListKeeper lists;
  FrameMemory memory;
  CpuFrameStats stats;

  // ---- used within a frame: the tool's balls at its start, goal, first contact, …
  cpu::ToolPlacement start, goal, contact, last_contact, target, straight, slid, end;
  // path of each tool ball in the present ContactPass
  cpu::AlignedArray<float> way_x_mm, way_y_mm, way_z_mm;
  float rounding_mm{0.0f};
  cpu::FrameReach reach, list_reach;  // reach that the frame needs; reach for new lists
  NearField near;
  std::vector<std::uint32_t> likely_place, likely_tool;  // pairs that were nearest in the previous frame
  std::size_t likely_count{0};

  // ---- scratch of the kernels
  struct Scratch {
    std::vector<std::uint32_t> near_place, near_tool, cone_place, cone_tool, block_place, block_tool;
    std::vector<std::uint32_t> large, touched_children, cleared;
    std::vector<float> near_score;
    std::vector<std::uint8_t> near_bin;
    std::vector<cpu::TouchingRow> rows;
    std::vector<Capsule> capsules;
  } scratch;
  std::chrono::steady_clock::time_point stage_began;

  void ReserveScratch();

  // ---- engine_frame.cpp
  ContactModel ComputeFrame(const FrameInput& input);
  double PlaceTool(const Pose& X_GT);
  [[nodiscard]] bool FindContact(double path_m, FrameSolution& solution);
  [[nodiscard]] bool SolveContacts(const FrameInput& input, const Matrix3& R_GT, FrameSolution& solution);
  double SlideTool(const FrameInput& input, bool turning, FrameSolution& solution);
  void Advance(const FrameInput& input, FrameSolution& solution);
  [[nodiscard]] ContactInput ContactInputOf(const Matrix3& R_GT, double contact_fraction, bool cutting) const;
  void SetPlaces(const Pose& X_GP, cpu::ToolPlacement& to) const;
  void EndStage(CpuStage stage);

  // ---- engine_passes.cpp
  struct Slid {
    double fraction, way_m;  ///< fraction of the path; way_m: path length of the point that moves farthest
    bool stopped;            ///< a ball stopped the slide
  };
  [[nodiscard]] double LongestWay(const cpu::ToolPlacement& a, const cpu::ToolPlacement& b) const;
  [[nodiscard]] cpu::ContactPass MakeContactPass(const cpu::ToolPlacement& from, const cpu::ToolPlacement& to,
                                                 double tolerance_m, double longest_m);
  [[nodiscard]] double FirstContactOnWay(const cpu::ContactPass& pass) const;
  [[nodiscard]] Slid SlideTo(const cpu::ToolPlacement& to, double tolerance_m, double max_m);
  [[nodiscard]] NearPair PairOf(std::size_t ball, std::size_t tool_ball) const;
  void FindNearField(const Matrix3& R_GT);
  void StoreNearField(const cpu::NearFieldPass& pass);
  void MeasureEngagement(const Vector3& spindle_axis_G, FrameSolution& solution);
  [[nodiscard]] std::size_t TouchingBall(double first);
  void Remove(std::int32_t only, double way_m, FrameSolution& solution);
  void FindCapsules(std::int32_t only);
  void BeginSplits(const cpu::SweepView& sweep);
  void ClearPoints(const cpu::SweepView& sweep, FrameSolution& solution);
};

}  // namespace osteon::simulation
