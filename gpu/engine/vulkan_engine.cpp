#include "gpu/engine/vulkan_engine.h"

#include <cmath>
#include <stdexcept>

#include "gpu/engine/engine_impl.h"

namespace osteon::gpu {

tl::expected<std::unique_ptr<VulkanEngine>, std::string> VulkanEngine::Create(
    const simulation::Bone& bone, const simulation::Tool& tool, const Pose& X_WG,
    const simulation::CuttingParams& params, const VulkanParams& vulkan) {
  if (tool.balls.empty() || tool.balls.size() > kMaxToolBalls)
    return tl::make_unexpected("tool: " + std::to_string(tool.balls.size()) + " balls, accepted 1 … " +
                               std::to_string(kMaxToolBalls));
  if (bone.materials.size() > kMaxMaterials)
    return tl::make_unexpected("bone: " + std::to_string(bone.materials.size()) +
                               " materials, accepted 1 … " + std::to_string(kMaxMaterials));
  if (params.split.on && vulkan.brute_force)
    return tl::make_unexpected("brute force: accepted without splitting");
  const std::size_t all_balls =
      bone.balls.size() + (params.split.on ? params.split.pool_blocks * kGroupSize : 0);
  if (all_balls > kMaxBoneBalls)
    return tl::make_unexpected("bone: " + std::to_string(all_balls) +
                               " balls with those that splitting may make, accepted 0 … " +
                               std::to_string(kMaxBoneBalls));
  auto context = OpenContext(vulkan.device, vulkan.validation, vulkan.overrides.arithmetic);
  if (!context) return tl::make_unexpected(context.error());
  try {
    auto impl = std::make_unique<Impl>();
    impl->tool = LayOutTool(tool);
    impl->lever_m = simulation::ToolLever(tool);
    impl->device_tool.resize(tool.balls.size());
    for (std::size_t t = 0; t < tool.balls.size(); ++t)
      impl->device_tool[impl->tool.number[t]] = static_cast<uint>(t);
    impl->materials = MaterialsUnderTool(bone, tool, params);
    impl->map = simulation::MaterialMap(bone);
    impl->X_WG = X_WG;
    impl->params = params;
    impl->brute_force = vulkan.brute_force;
    impl->frame_timeout_ns = static_cast<std::uint64_t>(std::llround(vulkan.frame_timeout_s * 1e9));
    if (params.split.on) impl->pool.emplace(bone.balls, params.split);
    if (const std::string refusal = impl->Open(std::move(*context), bone, vulkan); !refusal.empty())
      return tl::make_unexpected(refusal);
    impl->Upload(bone);
    impl->FillFrameConstants(bone);
    if (!impl->WarmUp(bone))
      return tl::make_unexpected(std::string("the Vulkan device did not finish a frame"));
    return std::unique_ptr<VulkanEngine>(new VulkanEngine(std::move(impl)));
  } catch (const vk::OutOfDeviceMemoryError& error) {
    return tl::make_unexpected("not enough memory on the Vulkan device for " +
                               std::to_string(bone.balls.size()) + " balls and " +
                               std::to_string(bone.points.size()) + " mass points (" + error.what() + ")");
  } catch (const std::exception& error) {
    return tl::make_unexpected(std::string("Vulkan: ") + error.what());
  }
}

VulkanEngine::VulkanEngine(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VulkanEngine::~VulkanEngine() {
  // The device may still be working: the last frame's readback can arrive before the frame ends, and a frame
  // may have exceeded its timeout. The memory that the device uses must stay until it is idle; if it does not
  // become idle, the program is leaked.
  if (impl_ && impl_->program && !impl_->program->IsIdle(kLostTimeout_ns)) (void)impl_->program.release();
}

simulation::ContactModel VulkanEngine::Step(const simulation::FrameInput& input) {
  Impl& impl = *impl_;
  if (impl.lost || !IsUsable(input)) {
    simulation::ContactModel refused;
    refused.status = impl.lost ? simulation::EngineStatus::kDeviceLost : simulation::EngineStatus::kBadInput;
    return refused;
  }
  if (!impl.memory.has_proxy) impl.memory.X_GP = impl.X_WG.inverse() * Pose(input.X_WT);
  const Pose X_WP = impl.X_WG * impl.memory.X_GP;
  return StepInParts(input, X_WP, simulation::SubframeCount(impl.lever_m, X_WP, Pose(input.X_WT)),
                     impl.memory, [&impl](const simulation::FrameInput& part) { return impl.Step(part); });
}

// Runs one subframe, with the lists of an earlier subframe or with new lists.
simulation::ContactModel VulkanEngine::Impl::Step(const simulation::FrameInput& input) {
  simulation::ContactModel refused;
  const Frame prepared = PrepareFrame(input);
  const bool lists_reach_far_enough =
      prepared.ball_reach_mm <= lists.ball_reach_mm && prepared.point_reach_mm <= lists.point_reach_mm;
  // whether the tool's cutting balls or its other balls have moved beyond their skin since the lists were
  // built
  const auto exceeds_skin = [&](float cutting_mm, float shaft_mm) {
    return cutting_mm > frame_constants.cutting_skin_mm || shaft_mm > frame_constants.shaft_skin_mm;
  };
  // Lists are valid while first contact is near the pose at which they were built. The host guesses whether
  // that is so. The device checks the guess and sets needs_rebuild if it was wrong.
  FrameMode mode = FrameMode::kLists;
  const bool was_split = pool && !pool->uploads().empty();
  if (had_no_contact &&
      (!lists.made || was_split ||
       exceeds_skin(prepared.cutting_displacement_goal_mm, prepared.shaft_displacement_goal_mm)))
    mode = FrameMode::kListsAtContact;
  else if (!lists.made || was_split || !lists_reach_far_enough ||
           exceeds_skin(prepared.cutting_displacement_start_mm, prepared.shaft_displacement_start_mm))
    mode = FrameMode::kListsAtProxy;
  bool done = RunFrame(prepared, mode);
  if (done && program->result().needs_rebuild != 0 && mode != FrameMode::kListsAtContact)
    done = RunFrame(prepared, FrameMode::kListsAtContact);
  if (!done) {
    lost = true;
    refused.status = simulation::EngineStatus::kDeviceLost;
    return refused;
  }
  const Frame& found = program->result();
  if (found.needs_rebuild != 0) {
    refused.status = simulation::EngineStatus::kOverloaded;
    return refused;
  }
  simulation::FrameSolution solution = Solution(found);
  solution.ploughing_work_J = PloughingWork(params, materials, solution, input.spindle_rad_per_s, input.dt_s);
  had_no_contact = solution.contact_fraction >= 1.0;
  if (pool && input.spindle_rad_per_s != 0.0) EndSplits(found, solution);
  simulation::ContactModel model = FinishFrame(params, materials, map, X_WG, input, solution, memory);
  if (pool) model.balls_not_split = pool->refused();
  return model;
}

simulation::CarvedState VulkanEngine::Snapshot() const {
  simulation::CarvedState state, memory_only;  // memory_only: without balls and points
  ToState(impl_->memory, memory_only);
  if (impl_->lost) return memory_only;
  state = memory_only;
  try {
    impl_->ReadState(state);
  } catch (const vk::SystemError&) {
    impl_->lost = true;
    return memory_only;
  }
  return state;
}

// Reads balls and points from the device.
void VulkanEngine::Impl::ReadState(simulation::CarvedState& state) const {
  if (!Flush()) throw vk::DeviceLostError("the balls of the lists did not go back in time");
  if (pool) {
    std::vector<vec4> balls(AllBalls());
    ReadBalls(*program, balls.data(), balls.size());
    pool->Save(balls, state);
    pool->ToSaved(state.contact);
  } else {
    state.balls.resize(ball_count * 4);
    ReadBalls(*program, state.balls.data(), ball_count);
  }
  std::vector<uint> states(point_count);
  program->Read(kBindPointStates, states.data(), states.size() * sizeof(uint));
  state.cleared.reserve(states.size());
  for (const uint point : states) state.cleared.push_back((point & kCleared) != 0 ? 1 : 0);
}

void VulkanEngine::Restore(const simulation::CarvedState& state) {
  if (impl_->lost) throw std::runtime_error("carved state: the Vulkan device is lost");
  if (state.balls.size() != impl_->ball_count * 4 || state.cleared.size() != impl_->point_count)
    throw std::invalid_argument("carved state: not of this bone");
  if (!impl_->pool && !state.split_balls.empty())
    throw std::invalid_argument("carved state: has split balls, split is off");
  CheckMemory(state, impl_->tool.balls.size());
  try {
    impl_->WriteState(state);
  } catch (const vk::SystemError& error) {
    impl_->lost = true;
    throw std::runtime_error(std::string("carved state: the Vulkan device is lost: ") + error.what());
  }
}

// Writes the state's balls and points to the device, and sets the frame memory from the state.
void VulkanEngine::Impl::WriteState(const simulation::CarvedState& state) {
  if (pool) {
    const SplitPool::DeviceState loaded = pool->Load(state);
    WriteBalls(*program, loaded.balls.data(), loaded.balls.size());
    program->Write(kBindBlocks, loaded.blocks.data(), loaded.blocks.size() * sizeof(Block));
  } else {
    WriteBalls(*program, state.balls.data(), ball_count);
  }
  std::vector<uint> states(point_count);
  program->Read(kBindPointStates, states.data(), states.size() * sizeof(uint));
  for (std::size_t i = 0; i < states.size(); ++i)
    states[i] = (states[i] & (kCleared - 1)) | (state.cleared[i] != 0 ? kCleared : 0);
  program->Write(kBindPointStates, states.data(), states.size() * sizeof(uint));
  memory = simulation::ToMemory(state);
  if (pool) pool->FromSaved(memory.contact);
  lists.made = false;
  had_no_contact = true;
  if (brute_force) ListEverything();
}

std::string VulkanEngine::device() const { return impl_->program->context().info.name; }

std::vector<PassTime> VulkanEngine::LastPassTimes() const {
  return impl_->memory.frame == 0 ? std::vector<PassTime>{} : impl_->program->PassTimes();
}

FrameStats VulkanEngine::LastFrameStats() const { return impl_->stats; }

int VulkanEngine::validation_messages() const {
  const Context& context = impl_->program->context();
  return context.validation ? context.shared->messages.load() : 0;
}

}  // namespace osteon::gpu
