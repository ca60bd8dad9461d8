#include "simulation/engine_cpu/cpu_engine.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "simulation/engine_cpu/engine_impl.h"

namespace osteon::simulation {
namespace {

// Finds the kernels of an instruction set; with an empty name, those of the best set.
// @throws std::invalid_argument if this processor does not have it.
const cpu::Kernels& KernelsFor(const std::string& name) {
  const auto& available = cpu::AvailableKernels();
  if (name.empty()) return *available.front();
  std::string names;
  for (const cpu::Kernels* kernels : available) {
    if (kernels->name == name) return *kernels;
    names += (names.empty() ? "" : ", ") + std::string(kernels->name);
  }
  throw std::invalid_argument(
      fmt::format("CPU engine: instruction set: found \"{}\", accepted one of {}", name, names));
}

// Largest number of blocks of eight children that split balls may have.
// @throws std::invalid_argument if params are not accepted.
std::size_t MaxChildBlocks(const SplitParams& params) {
  if (!params.on) return 0;
  const BallSplitter accepted({}, params);
  return params.pool_blocks * ((accepted.slots() + 7) / 8);
}

// Checks bone and tool. @throws std::invalid_argument if the engine does not accept them.
void Check(const Bone& bone, const Tool& tool) {
  if (bone.materials.size() > kMaxMaterials)
    throw std::invalid_argument(
        fmt::format("bone: found {} materials, accepted 0 … {}", bone.materials.size(), kMaxMaterials));
  for (const MassPoint& point : bone.points)
    if (point.material >= kMaxMaterials)
      throw std::invalid_argument(fmt::format("bone: material of a mass point: found {}, accepted 0 … {}",
                                              point.material, kMaxMaterials - 1));
  if (tool.balls.empty() || tool.balls.size() > CpuEngine::kMaxToolBalls)
    throw std::invalid_argument(
        fmt::format("tool: found {} balls, accepted 1 … {}", tool.balls.size(), CpuEngine::kMaxToolBalls));
}

}  // namespace

const char* NameOf(CpuStage stage) {
  switch (stage) {
    case CpuStage::kPlace:
      return "place";
    case CpuStage::kLists:
      return "lists";
    case CpuStage::kContact:
      return "contact";
    case CpuStage::kNearField:
      return "near field";
    case CpuStage::kLaw:
      return "law";
    case CpuStage::kSlide:
      return "slide";
    case CpuStage::kEngagement:
      return "engagement";
    case CpuStage::kRemoval:
      return "removal";
    case CpuStage::kClearing:
      return "clearing";
    case CpuStage::kFinish:
      return "finish";
    case CpuStage::kCount:
      break;
  }
  return "?";
}

std::vector<std::string> CpuInstructionSets() {
  std::vector<std::string> names;
  for (const cpu::Kernels* kernels : cpu::AvailableKernels()) names.emplace_back(kernels->name);
  return names;
}

CpuEngine::Impl::Impl(const Bone& bone_in, const Tool& tool_in, const Pose& X_WG_in,
                      const CuttingParams& params_in, const CpuParams& cpu_in)
    : tool(tool_in),
      lever_m(ToolLever(tool_in)),
      materials(MaterialsUnderTool(bone_in, tool_in, params_in)),
      map(bone_in),
      X_WG(X_WG_in),
      params(params_in),
      cpu(cpu_in),
      kernels(KernelsFor(cpu_in.instruction_set)),
      bone(bone_in, params_in.engaged_layer_m, MaxChildBlocks(params_in.split)),
      balls(tool_in),
      split(params_in.split.on ? std::make_optional<cpu::SplitBlocks>(bone, params_in.split) : std::nullopt),
      search(balls, std::max(bone.ball_tree.cluster_count(), bone.point_tree.cluster_count()),
             cpu_in.list_capacity),
      lists({.kernels = kernels,
             .tool = balls,
             .bone = bone,
             .split = split ? &*split : nullptr,
             .search = search},
            cpu_in.list_capacity, cpu_in.brute_force, cpu_in.look_ahead) {
  for (cpu::ToolPlacement* place : {&start, &goal, &contact, &last_contact, &target, &straight, &slid, &end})
    *place = cpu::ToolPlacement(balls.count());
  for (cpu::AlignedArray<float>* way : {&way_x_mm, &way_y_mm, &way_z_mm})
    *way = cpu::AlignedArray<float>(balls.count() + 8);
  likely_place.resize(cpu::kBinCount + cpu::kLanes), likely_tool.resize(cpu::kBinCount + cpu::kLanes);
  ReserveScratch();
}

// Allocates the kernels' scratch memory. Kernels write whole vectors, so each array has `slack` more
// elements.
void CpuEngine::Impl::ReserveScratch() {
  const std::size_t block_pairs = cpu::kLanes * balls.count(), slack = 64;
  for (auto* pairs : {&scratch.near_place, &scratch.near_tool}) pairs->resize(cpu::kNearCapacity + slack);
  for (auto* pairs : {&scratch.cone_place, &scratch.cone_tool})
    pairs->resize(cpu::kConeCapacity + block_pairs + slack);
  for (auto* pairs : {&scratch.block_place, &scratch.block_tool}) pairs->resize(block_pairs + slack);
  scratch.near_score.resize(cpu::kNearCapacity + slack), scratch.near_bin.resize(cpu::kNearCapacity + slack);
  scratch.cleared.resize(bone.point_count() + slack);
  scratch.rows.resize(std::max<std::size_t>(4096, balls.count() + slack));
  scratch.capsules.reserve(2 * balls.cutting_count());
  if (!split) return;
  scratch.large.resize(bone.ball_count() + slack);
  scratch.touched_children.resize(split->params().pool_blocks * split->stride() + slack);
}

CpuEngine::CpuEngine(const Bone& bone, const Tool& tool, const Pose& X_WG, const CuttingParams& params,
                     const CpuParams& cpu) {
  Check(bone, tool);
  impl_ = std::make_unique<Impl>(bone, tool, X_WG, params, cpu);
}
CpuEngine::~CpuEngine() = default;

ContactModel CpuEngine::Step(const FrameInput& input) {
  Impl& impl = *impl_;
  if (!IsUsable(input)) {
    ContactModel refused;
    refused.status = EngineStatus::kBadInput;
    return refused;
  }
  impl.stats = {};
  impl.lists.BeginFrame();
  if (!impl.memory.has_proxy) impl.memory.X_GP = impl.X_WG.inverse() * Pose(input.X_WT);
  const Pose X_WP = impl.X_WG * Pose(impl.memory.X_GP);
  const ContactModel model =
      StepInParts(input, X_WP, SubframeCount(impl.lever_m, X_WP, Pose(input.X_WT)), impl.memory,
                  [&impl](const FrameInput& part) { return impl.ComputeFrame(part); });
  impl.stats.lists_made = impl.lists.made_in_frame();
  impl.stats.ball_rows = impl.lists.ball_row_count();
  impl.stats.listed_balls = cpu::kLanes * impl.lists.ball_block_count();
  impl.stats.listed_points = impl.lists.listed_points();
  return model;
}

CarvedState CpuEngine::Snapshot() const {
  const Impl& impl = *impl_;
  CarvedState state;
  state.balls.resize(4 * impl.bone.ball_count());
  for (std::size_t i = 0; i < impl.bone.ball_count(); ++i) impl.bone.ReadFloats(i, &state.balls[4 * i]);
  state.cleared = impl.bone.cleared();
  ToState(impl.memory, state);
  if (!impl.split) return state;
  impl.split->Save(state);
  impl.split->ToSaved(state.contact);
  return state;
}

void CpuEngine::Restore(const CarvedState& state) {
  Impl& impl = *impl_;
  if (state.cleared.size() != impl.bone.point_count() || state.balls.size() != 4 * impl.bone.ball_count())
    throw std::invalid_argument("carved state: not of this bone");
  if (impl.split)
    impl.split->CheckState(state);
  else if (!state.split_balls.empty())
    throw std::invalid_argument("carved state: has split balls, split is off");
  CheckMemory(state, impl.tool.balls.size());
  for (std::size_t i = 0; i < impl.bone.ball_count(); ++i) impl.bone.WriteFloats(i, &state.balls[4 * i]);
  impl.bone.SetCleared(state.cleared);
  impl.memory = ToMemory(state);
  if (impl.split) {
    impl.split->Load(state);
    impl.split->FromSaved(impl.memory.contact);
  }
  impl.bone.ball_tree.Reset(), impl.bone.point_tree.Reset();
  impl.lists.Discard();
  impl.likely_count = 0;
}

std::string CpuDeviceText(const std::string& instruction_set) {
  // replace Highway's names of AVX-512 and of plain C++
  const std::string& name = instruction_set;
  const std::string plain = name == "N_AVX3"                           ? "AVX-512"
                            : name == "N_SCALAR" || name == "N_EMU128" ? "plain C++"
                                                                       : name.substr(2);
  return "one thread, " + plain;
}

std::string CpuEngine::device() const { return CpuDeviceText(impl_->kernels.name); }

const CpuFrameStats& CpuEngine::LastFrameStats() const { return impl_->stats; }

}  // namespace osteon::simulation
