#include "gpu/program/frame_program.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cstring>

#include <fmt/format.h>

#include "gpu/program/double_single.h"
#include "gpu/spirv/passes.h"

namespace osteon::gpu {
namespace {

// largest number of passes of a frame; size of the pool of timestamps
constexpr std::uint32_t kMaxPasses = 16;

// Bytes of each storage buffer, by binding.
std::array<std::size_t, kBindings> BufferBytes(const ProgramSizes& n) {
  std::array<std::size_t, kBindings> bytes{};
  bytes[kBindFrame] = sizeof(Frame);
  bytes[kBindTool] = 4 * n.tool_balls * sizeof(vec4);
  bytes[kBindClusterPairs] = (n.ball_clusters + n.point_clusters) * sizeof(ClusterPairs);
  bytes[kBindToolRefs] = n.tool_refs * sizeof(uint);
  bytes[kBindBalls] = std::min<std::size_t>(n.balls, kBallsPerBuffer) * sizeof(vec4);
  bytes[kBindMoreBalls] = (n.balls - std::min<std::size_t>(n.balls, kBallsPerBuffer)) * sizeof(vec4);
  bytes[kBindPoints] = n.points * sizeof(vec4);
  bytes[kBindPointStates] = n.points * sizeof(uint);
  bytes[kBindPointUnits] = n.points * sizeof(uint);
  bytes[kBindLiveBalls] = n.live * sizeof(vec4);
  bytes[kBindLiveEntries] = n.live * (sizeof(ListEntry) + sizeof(ShaftPair));
  bytes[kBindLivePoints] = n.live * sizeof(vec4);
  bytes[kBindPointEntries] = n.live * sizeof(ListEntry);
  bytes[kBindPackedPairs] = n.packed_pairs * sizeof(uint);
  bytes[kBindSlots] = n.balls * sizeof(uint);
  bytes[kBindSplitEvents] = std::max<std::size_t>(1, n.split_events) * sizeof(SplitEvent);
  bytes[kBindUploads] = std::max<std::size_t>(1, n.uploads) * sizeof(SplitUpload);
  bytes[kBindBlocks] = std::max<std::size_t>(1, n.blocks) * sizeof(Block);
  bytes[kBindReadback] = sizeof(Readback) + 8;
  return bytes;
}

}  // namespace

std::string FrameProgram::Refusal(const Context& context, const ProgramSizes& sizes,
                                  const VulkanOverrides& overrides) {
  const auto limits = context.physical->getProperties().limits;
  const Subgroups& subgroups = context.subgroups;
  if (overrides.subgroup_size != 0 && overrides.subgroup_size != subgroups.size &&
      (!subgroups.can_choose || overrides.subgroup_size < subgroups.min_size ||
       overrides.subgroup_size > subgroups.max_size || !std::has_single_bit(overrides.subgroup_size)))
    return fmt::format("subgroups of {}: the device accepts {}", overrides.subgroup_size,
                       subgroups.can_choose
                           ? fmt::format("{} … {}, powers of two", subgroups.min_size, subgroups.max_size)
                           : fmt::format("{}", subgroups.size));
  if (overrides.bone_ball_bits != 0 &&
      (overrides.bone_ball_bits < BoneBits(sizes.balls) || overrides.bone_ball_bits > kMaxBoneBits))
    return fmt::format("{} bits for a bone ball, accepted {} … {}", overrides.bone_ball_bits,
                       BoneBits(sizes.balls), kMaxBoneBits);
  const std::string bone_size = fmt::format("{} balls and {} mass points", sizes.balls, sizes.points);
  double needed = 0.0;
  const auto buffers = BufferBytes(sizes);
  for (const uint buffer :
       {kBindLiveBalls, kBindLivePoints, kBindTool, kBindPackedPairs, kBindLiveEntries, kBindPointEntries})
    if (buffers[buffer] / sizeof(vec4) > limits.maxTexelBufferElements)
      return fmt::format("{}: a texel buffer of {} elements, the device's largest has {}", bone_size,
                         buffers[buffer] / sizeof(vec4), limits.maxTexelBufferElements);
  for (const std::size_t bytes : buffers) {
    needed += static_cast<double>(bytes);
    if (bytes > limits.maxStorageBufferRange)
      return fmt::format("{}: a buffer of {:.0f} MB, the device's largest is {:.0f} MB", bone_size,
                         static_cast<double>(bytes) * 1e-6, limits.maxStorageBufferRange * 1e-6);
  }
  if (needed > context.info.memory_bytes)
    return fmt::format("{} need {:.0f} MB, the device has {:.0f} MB", bone_size, needed * 1e-6,
                       context.info.memory_bytes * 1e-6);
  return "";
}

FrameProgram::FrameProgram(std::unique_ptr<Context> opened, const ProgramSizes& sizes,
                           const VulkanParams& params)
    : context_(std::move(opened)), sizes_(sizes) {
  const VulkanOverrides& overrides = params.overrides;
  gpu_ = overrides.variant == PassVariant::kGpu ||
         (overrides.variant == PassVariant::kAuto && context_->info.kind != "cpu");
  asks_subgroup_size_ = overrides.subgroup_size != 0 && overrides.subgroup_size != context_->subgroups.size;
  subgroup_size_ = asks_subgroup_size_ ? overrides.subgroup_size : context_->subgroups.size;
  bone_bits_ = overrides.bone_ball_bits != 0 ? overrides.bone_ball_bits : BoneBits(sizes.balls);
  max_workgroups_ = context_->physical->getProperties().limits.maxComputeWorkGroupCount[0];
  if (overrides.max_workgroups != 0) max_workgroups_ = std::min(max_workgroups_, overrides.max_workgroups);
  policy_ = overrides.fence != FencePolicy::kAuto ? overrides.fence
            : gpu_                                ? FencePolicy::kReport
                                                  : FencePolicy::kWait;
  if (!gpu_ && policy_ == FencePolicy::kReport) policy_ = FencePolicy::kPoll;
  command_pool_ =
      vk::raii::CommandPool(*context_->device, vk::CommandPoolCreateInfo({}, context_->queue_family));
  fence_ = vk::raii::Fence(*context_->device, vk::FenceCreateInfo(vk::FenceCreateFlagBits::eSignaled));
  const auto families = context_->physical->getQueueFamilyProperties();
  if (params.time_passes && families[context_->queue_family].timestampValidBits != 0) {
    stamp_period_ns_ = context_->physical->getProperties().limits.timestampPeriod;
    stamps_ = vk::raii::QueryPool(*context_->device,
                                  vk::QueryPoolCreateInfo({}, vk::QueryType::eTimestamp, kMaxPasses + 1));
  }
  MakeBuffers();
  NameForLayers(*context_, FrameBuffer(), kFrameBufferName);
  const auto begun = std::chrono::steady_clock::now();
  MakePipelines(overrides.fused_fma.value_or(context_->fused_fma));
  pipelines_s_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  for (const auto& passes : run_passes_) commands_.push_back(Record(passes, nullptr));
}

void FrameProgram::MakeBuffers() {
  const auto bytes = BufferBytes(sizes_);
  for (uint i = 0; i < kBindings; ++i) {
    const bool host = i == kBindTool || i == kBindClusterPairs || i == kBindToolRefs || i == kBindUploads;
    const bool read = i == kBindReadback || i == kBindSplitEvents;
    if (i != kBindFrame)
      buffers_[i] = MakeBuffer(*context_, bytes[i],
                               read   ? Placement::kReadBack
                               : host ? Placement::kShared
                                      : Placement::kDevice);
  }
  if (!gpu_) {
    frame_in_ = MakeBuffer(*context_, sizeof(Frame), Placement::kReadBack);
    return;
  }
  // If possible, the host writes the frame directly to the memory that the passes read. The readback is in
  // memory that the host reads fast.
  frame_in_ = MakeBuffer(*context_, sizeof(Frame), Placement::kShared);
  copies_in_ = !frame_in_.device_local;
  if (copies_in_) buffers_[kBindFrame] = MakeBuffer(*context_, sizeof(Frame), Placement::kDevice);
  std::memset(buffers_[kBindReadback].mapped, 0, sizeof(Readback));
}

void FrameProgram::Copy(const Buffer& from, const Buffer& to, vk::DeviceSize size,
                        vk::DeviceSize place) const {
  vk::raii::CommandBuffers once(*context_->device, {*command_pool_, vk::CommandBufferLevel::ePrimary, 1});
  once[0].begin(vk::CommandBufferBeginInfo(vk::CommandBufferUsageFlagBits::eOneTimeSubmit));
  once[0].copyBuffer(*from.buffer, *to.buffer, vk::BufferCopy(0, place, size));
  once[0].end();
  const vk::CommandBuffer raw = *once[0];
  context_->queue->submit(vk::SubmitInfo(nullptr, nullptr, raw));
  context_->queue->waitIdle();
}

void FrameProgram::Write(uint binding, const void* data, std::size_t size, std::size_t place) const {
  if (size == 0) return;
  const Buffer staging = MakeBuffer(*context_, size, Placement::kUpload);
  std::memcpy(staging.mapped, data, size);
  Copy(staging, buffers_[binding], size, place);
}

void FrameProgram::Read(uint binding, void* data, std::size_t size) const {
  if (size == 0) return;
  const Buffer staging = MakeBuffer(*context_, size, Placement::kReadBack);
  Copy(buffers_[binding], staging, size, 0);
  std::memcpy(data, staging.mapped, size);
}

void FrameProgram::MakePipelines(bool fused_fma) {
  const vk::raii::Device& device = *context_->device;
  std::vector<vk::DescriptorSetLayoutBinding> bindings;
  for (uint i = 0; i < kBindings; ++i)
    bindings.emplace_back(i, vk::DescriptorType::eStorageBuffer, 1, vk::ShaderStageFlagBits::eCompute);
  for (const uint i : {kBindBallTexels, kBindPointTexels, kBindToolTexels, kBindPackedPairTexels,
                       kBindEntryTexels, kBindPointEntryTexels})
    bindings.emplace_back(i, vk::DescriptorType::eUniformTexelBuffer, 1, vk::ShaderStageFlagBits::eCompute);
  set_layout_ = vk::raii::DescriptorSetLayout(device, vk::DescriptorSetLayoutCreateInfo({}, bindings));
  layout_ = vk::raii::PipelineLayout(device, vk::PipelineLayoutCreateInfo({}, *set_layout_));

  // specialization constants of the shaders; `entries` assigns their ids
  struct Constants {
    VkBool32 one_cutter;
    uint ball_clusters;
    uint lanes;
    VkBool32 split;
    VkBool32 contact_sphere;
    uint materials;
    VkBool32 on_gpu;
    uint tool_rest;  // kToolRemainder: where the remainders begin in the tool's buffer
    uint bone_bits;
    VkBool32 lower_words;  // false: the pass finds only the upper words of the smallest keys
    VkBool32 fused_fma;
  } const constants{.one_cutter = sizes_.cutters == 1 ? VK_TRUE : VK_FALSE,
                    .ball_clusters = static_cast<uint>(sizes_.ball_clusters),
                    .lanes = lanes(),
                    .split = sizes_.blocks > 0 ? VK_TRUE : VK_FALSE,
                    .contact_sphere = sizes_.contact_sphere ? VK_TRUE : VK_FALSE,
                    .materials = static_cast<uint>(sizes_.materials),
                    .on_gpu = gpu_ ? VK_TRUE : VK_FALSE,
                    .tool_rest = static_cast<uint>(2 * sizes_.tool_balls),
                    .bone_bits = bone_bits_,
                    .lower_words = VK_TRUE,
                    .fused_fma = fused_fma ? VK_TRUE : VK_FALSE};
  const std::array<vk::SpecializationMapEntry, 11> entries{
      {{1, offsetof(Constants, one_cutter), sizeof(VkBool32)},
       {2, offsetof(Constants, ball_clusters), sizeof(uint)},
       {3, offsetof(Constants, lanes), sizeof(uint)},
       {4, offsetof(Constants, split), sizeof(VkBool32)},
       {5, offsetof(Constants, contact_sphere), sizeof(VkBool32)},
       {6, offsetof(Constants, materials), sizeof(uint)},
       {7, offsetof(Constants, on_gpu), sizeof(VkBool32)},
       {8, offsetof(Constants, tool_rest), sizeof(uint)},
       {9, offsetof(Constants, bone_bits), sizeof(uint)},
       {10, offsetof(Constants, lower_words), sizeof(VkBool32)},
       {11, offsetof(Constants, fused_fma), sizeof(VkBool32)}}};
  Constants wide_groups = constants;  // on a GPU: larger workgroups, see kWideLanes
  if (gpu_) wide_groups.lanes = kWideLanes;
  const bool without_int64 = !HasInt64(context_->arithmetic),
             without_doubles = !HasDoubles(context_->arithmetic);
  // Compiles a pass and returns its index in passes_. groups: offset of the pass's DispatchArgs in Frame.
  const auto add_pass = [&](const char* name, const ShaderCode& code, const Constants& own,
                            std::size_t groups, NextPassNeeds next_needs) {
    const vk::SpecializationInfo specialization(static_cast<std::uint32_t>(entries.size()), entries.data(),
                                                sizeof(Constants), &own);
    const std::span<const std::uint32_t> spirv = without_doubles
                                                     ? (without_int64 ? code.floats : code.floats_int64)
                                                     : (without_int64 ? code.words : code.int64);
    const vk::raii::ShaderModule module(device,
                                        vk::ShaderModuleCreateInfo({}, spirv.size_bytes(), spirv.data()));
    const vk::PipelineShaderStageRequiredSubgroupSizeCreateInfo size(subgroup_size_);
    vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module, "main",
                                            &specialization);
    // without this feature a driver may leave some invocations of a subgroup inactive, which the passes also
    // support
    if (context_->subgroups.can_be_full && own.lanes % subgroup_size_ == 0)
      stage.flags = vk::PipelineShaderStageCreateFlagBits::eRequireFullSubgroups;
    if (asks_subgroup_size_) stage.pNext = &size;
    passes_.push_back(
        {name, vk::raii::Pipeline(device, nullptr, vk::ComputePipelineCreateInfo({}, stage, *layout_)),
         groups, next_needs, std::max(1u, own.lanes / lanes())});
    return passes_.size() - 1;
  };
  // offsets of the numbers of workgroups: over the lists of ball pairs, and over all lists
  const std::size_t pair_groups = offsetof(Frame, pair_work), all_groups = offsetof(Frame, all_work);
  // Adds a pass that finds smallest keys; returns the indices of its dispatches. Without 64-bit integers, an
  // additional first dispatch (named `first`) finds the keys' upper words.
  const auto add_key_pass = [&](const char* name, const char* first, const ShaderCode& code,
                                const Constants& own, std::size_t groups) {
    std::vector<std::size_t> dispatches;
    Constants upper = own;
    upper.lower_words = VK_FALSE;
    if (without_int64) dispatches.push_back(add_pass(first, code, upper, groups, NextPassNeeds::kResults));
    dispatches.push_back(add_pass(name, code, own, groups, NextPassNeeds::kResults));
    return dispatches;
  };
  // indices into passes_, in the order of execution
  std::vector<std::size_t> after_contact =
      add_key_pass("near_field", "near_field_upper_words", kCode_near_field, wide_groups, pair_groups);
  if (!gpu_) {
    // one subgroup computes the solution in a pass of its own; on a GPU, the near field's last workgroup
    // computes it
    Constants alone = constants;
    alone.lanes = subgroup_size_;
    after_contact.push_back(add_pass("solve", kCode_solve, alone, kOneWorkgroup, NextPassNeeds::kResults));
  }
  for (const std::size_t slide :
       add_key_pass("slide_engage", "slide_engage_upper_words", kCode_slide_engage, wide_groups, all_groups))
    after_contact.push_back(slide);
  after_contact.push_back(add_pass("remove_clear", kCode_remove_clear, wide_groups,
                                   offsetof(Frame, clear_work), NextPassNeeds::kNothing));
  if (sizes_.contact_sphere)
    after_contact.insert(after_contact.begin(), add_pass("touching", kCode_touching, constants, pair_groups,
                                                         NextPassNeeds::kResults));
  const std::vector<std::size_t> contact = add_key_pass("contact", "contact_upper_words", kCode_contact,
                                                        constants, pair_groups),
                                 path =
                                     add_key_pass("path_contact", "path_contact_upper_words",
                                                  kCode_path_contact, constants, offsetof(Frame, path_work));
  const std::vector<std::size_t> pick = {add_pass("pick_balls", kCode_pick_balls, constants,
                                                  offsetof(Frame, path_work), NextPassNeeds::kNothing),
                                         add_pass("pick_points", kCode_pick_points, constants,
                                                  offsetof(Frame, point_work), NextPassNeeds::kGroupCount)};
  std::vector<std::size_t> flush_and_load = {
      add_pass("flush", kCode_flush, constants, offsetof(Frame, flush_work), NextPassNeeds::kResults)};
  if (sizes_.blocks > 0)
    flush_and_load.push_back(add_pass("load_children", kCode_load_children, constants,
                                      offsetof(Frame, upload_work), NextPassNeeds::kResults));
  const auto concatenate = [](std::initializer_list<std::vector<std::size_t>> parts) {
    std::vector<std::size_t> whole;
    for (const auto& part : parts) whole.insert(whole.end(), part.begin(), part.end());
    return whole;
  };
  const auto run = [&](FrameMode mode) -> std::vector<std::size_t>& {
    return run_passes_[static_cast<std::size_t>(mode)];
  };
  run(FrameMode::kLists) = concatenate({contact, after_contact});
  run(FrameMode::kListsRefreshed) =
      concatenate({{add_pass("refresh", kCode_refresh, constants, all_groups, NextPassNeeds::kResults)},
                   contact,
                   after_contact});
  run(FrameMode::kListsAtProxy) = concatenate({flush_and_load, pick, contact, after_contact});
  run(FrameMode::kListsAtContact) = concatenate({flush_and_load, path, pick, after_contact});
  run(FrameMode::kFlush) = flush_and_load;

  const std::array<vk::DescriptorPoolSize, 2> size{
      {{vk::DescriptorType::eStorageBuffer, kBindings}, {vk::DescriptorType::eUniformTexelBuffer, 6}}};
  pool_ = vk::raii::DescriptorPool(
      device, vk::DescriptorPoolCreateInfo(vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 1, size));
  sets_ = vk::raii::DescriptorSets(device, vk::DescriptorSetAllocateInfo(*pool_, *set_layout_));
  for (uint i = 0; i < kBindings; ++i) {
    const Buffer& bound = i == kBindFrame ? FrameBuffer() : buffers_[i];
    const vk::DescriptorBufferInfo info(*bound.buffer, 0, VK_WHOLE_SIZE);
    device.updateDescriptorSets(
        vk::WriteDescriptorSet(*sets_[0], i, 0, vk::DescriptorType::eStorageBuffer, nullptr, info), nullptr);
  }
  // Binds a read-only view of a buffer as texels of this format.
  const auto view = [&](uint binding, uint buffer, vk::Format format) {
    views_.emplace_back(device,
                        vk::BufferViewCreateInfo({}, *buffers_[buffer].buffer, format, 0, VK_WHOLE_SIZE));
    const vk::BufferView made = *views_.back();
    device.updateDescriptorSets(
        vk::WriteDescriptorSet(*sets_[0], binding, 0, vk::DescriptorType::eUniformTexelBuffer, nullptr,
                               nullptr, made),
        nullptr);
  };
  view(kBindBallTexels, kBindLiveBalls, vk::Format::eR32G32B32A32Sfloat);
  view(kBindPointTexels, kBindLivePoints, vk::Format::eR32G32B32A32Sfloat);
  view(kBindToolTexels, kBindTool, vk::Format::eR32G32B32A32Sfloat);
  view(kBindPackedPairTexels, kBindPackedPairs, vk::Format::eR32G32B32A32Uint);
  view(kBindEntryTexels, kBindLiveEntries, vk::Format::eR32G32B32A32Uint);
  view(kBindPointEntryTexels, kBindPointEntries, vk::Format::eR32G32B32A32Uint);
}

vk::raii::CommandBuffer FrameProgram::Record(const std::vector<std::size_t>& passes,
                                             const Frame* known) const {
  using Access = vk::AccessFlagBits;
  using Stage = vk::PipelineStageFlagBits;
  vk::raii::CommandBuffers made(*context_->device, {*command_pool_, vk::CommandBufferLevel::ePrimary, 1});
  vk::raii::CommandBuffer commands = std::move(made[0]);
  const auto barrier = [&](vk::PipelineStageFlags from, vk::AccessFlags wrote, vk::PipelineStageFlags to,
                           vk::AccessFlags reads) {
    commands.pipelineBarrier(from, to, {}, vk::MemoryBarrier(wrote, reads), nullptr, nullptr);
  };
  const Buffer& frame = FrameBuffer();
  commands.begin(vk::CommandBufferBeginInfo());
  std::uint32_t stamp_number = 0;
  const auto stamp = [&] {
    if (stamp_period_ns_ > 0.0) commands.writeTimestamp(Stage::eBottomOfPipe, *stamps_, stamp_number++);
  };
  if (stamp_period_ns_ > 0.0) commands.resetQueryPool(*stamps_, 0, kMaxPasses + 1);
  if (copies_in_) {
    commands.copyBuffer(*frame_in_.buffer, *frame.buffer, vk::BufferCopy(0, 0, sizeof(Frame)));
    barrier(Stage::eTransfer, Access::eTransferWrite, Stage::eComputeShader | Stage::eDrawIndirect,
            Access::eShaderRead | Access::eShaderWrite | Access::eIndirectCommandRead);
  }
  stamp();
  commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *layout_, 0, *sets_[0], nullptr);
  for (const std::size_t i : passes) {
    const Pass& pass = passes_[i];
    commands.bindPipeline(vk::PipelineBindPoint::eCompute, *pass.pipeline);
    if (pass.groups == kOneWorkgroup) {
      commands.dispatch(1, 1, 1);
    } else if (known) {
      DispatchArgs groups;
      std::memcpy(&groups, reinterpret_cast<const char*>(known) + pass.groups, sizeof(DispatchArgs));
      commands.dispatch((groups.x + pass.share - 1) / pass.share, groups.y, groups.z);
    } else
      commands.dispatchIndirect(*frame.buffer, pass.groups);
    const vk::AccessFlags reads = Access::eShaderRead | Access::eShaderWrite;
    if (pass.next_needs == NextPassNeeds::kResults && i != passes.back())
      barrier(Stage::eComputeShader, Access::eShaderWrite, Stage::eComputeShader, reads);
    if (pass.next_needs == NextPassNeeds::kGroupCount)
      barrier(Stage::eComputeShader, Access::eShaderWrite, Stage::eComputeShader | Stage::eDrawIndirect,
              reads | Access::eIndirectCommandRead);
    stamp();
  }
  barrier(Stage::eComputeShader, Access::eShaderWrite,
          Stage::eComputeShader | Stage::eDrawIndirect | Stage::eTransfer | Stage::eHost,
          Access::eShaderRead | Access::eShaderWrite | Access::eIndirectCommandRead | Access::eTransferRead |
              Access::eHostRead);
  commands.end();
  return commands;
}

// Records the commands of kLists with constant numbers of workgroups, which the host knows once the lists are
// built. Does nothing if the numbers are those of the last recording.
void FrameProgram::RecordLists(const Frame& frame) {
  const std::array<DispatchArgs, 3> groups{frame.pair_work, frame.all_work, frame.clear_work};
  if (std::memcmp(&groups, &recorded_, sizeof(groups)) == 0) return;
  auto& commands = commands_[static_cast<std::size_t>(FrameMode::kLists)];
  commands = Record(run_passes_[static_cast<std::size_t>(FrameMode::kLists)], &frame);
  recorded_ = groups;
}

bool FrameProgram::AwaitFence(std::uint64_t timeout_ns) {
  if (policy_ != FencePolicy::kWait) {
    // a GPU finishes within tens of microseconds, so polling is faster than waiting for the operating
    // system's wake-up
    for (int i = 0; i < 20'000; ++i)
      if (fence_.getStatus() == vk::Result::eSuccess) return true;
  }
  return context_->device->waitForFences(*fence_, VK_TRUE, timeout_ns) == vk::Result::eSuccess;
}

bool FrameProgram::AwaitReadback(std::uint64_t timeout_ns) {
  const volatile uint* number = &readback().sequence;
  // The readback is complete when it has this frame's number and its checksum fits.
  const auto is_complete = [&] {
    if (*number != sequence_) return false;
    std::atomic_thread_fence(std::memory_order_acquire);
    std::array<uint, kFrameBytes / sizeof(uint)> words;
    std::memcpy(words.data(), &readback().frame, kFrameBytes);
    uint sum = 0;
    for (const uint word : words) sum += word;
    return sum == readback().sum;
  };
  for (int i = 0; i < 1'000'000; ++i)  // poll for some milliseconds before waiting
    if (is_complete()) return true;
  return AwaitFence(timeout_ns) && is_complete();
}

bool FrameProgram::Run(const Frame& frame, FrameMode mode, std::uint64_t timeout_ns) try {
  const bool without_doubles = !HasDoubles(context_->arithmetic);
  last_mode_ = mode;
  // Wait until the last frame has ended: its readback may have arrived before its fence was signalled.
  if (!AwaitFence(timeout_ns)) return false;
  Frame asked = frame;
  asked.sequence = ++sequence_;
  if (without_doubles) ToDoubleSingles(asked);
  std::memcpy(frame_in_.mapped, &asked, sizeof(Frame));
  if (gpu_ && mode == FrameMode::kLists) RecordLists(frame);
  if (!RunCommands(mode, timeout_ns)) return false;
  if (without_doubles) {
    decoded_ = raw_result();
    FromDoubleSingles(decoded_);
  }
  return true;
} catch (const std::exception&) {
  return false;
}

bool FrameProgram::RunCommands(FrameMode mode, std::uint64_t timeout_ns) {
  const vk::CommandBuffer raw = *commands_[static_cast<std::size_t>(mode)];
  context_->device->resetFences(*fence_);
  context_->queue->submit(vk::SubmitInfo(nullptr, nullptr, raw), *fence_);
  if (policy_ != FencePolicy::kReport || mode == FrameMode::kFlush) return AwaitFence(timeout_ns);
  // The checksum covers only the readback. If the frame has split events, wait for the fence before reading
  // them.
  return AwaitReadback(timeout_ns) && (raw_result().split_event_count == 0 || AwaitFence(timeout_ns));
}

bool FrameProgram::IsIdle(std::uint64_t timeout_ns) const try {
  return context_->device->waitForFences(*fence_, VK_TRUE, timeout_ns) == vk::Result::eSuccess;
} catch (const std::exception&) {
  return true;  // a lost device has no more work
}

std::vector<PassTime> FrameProgram::PassTimes() const {
  std::vector<PassTime> times;
  if (stamp_period_ns_ <= 0.0) return times;
  const std::vector<std::size_t>& passes = run_passes_[static_cast<std::size_t>(last_mode_)];
  const std::size_t count = passes.size() + 1;
  const auto [result, ticks] =
      stamps_.getResults<std::uint64_t>(0, static_cast<std::uint32_t>(count), count * sizeof(std::uint64_t),
                                        sizeof(std::uint64_t), vk::QueryResultFlagBits::e64);
  if (result != vk::Result::eSuccess) return times;
  for (std::size_t i = 0; i < passes.size(); ++i)
    times.push_back(
        {passes_[passes[i]].name, static_cast<double>(ticks[i + 1] - ticks[i]) * stamp_period_ns_ * 1e-9});
  return times;
}

}  // namespace osteon::gpu
