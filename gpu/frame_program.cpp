#include "gpu/frame_program.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "gpu/spirv/advance.h"
#include "gpu/spirv/clear.h"
#include "gpu/spirv/contact.h"
#include "gpu/spirv/contact_live.h"
#include "gpu/spirv/engage.h"
#include "gpu/spirv/near.h"
#include "gpu/spirv/pick_balls.h"
#include "gpu/spirv/pick_points.h"
#include "gpu/spirv/place.h"
#include "gpu/spirv/planes.h"
#include "gpu/spirv/reach.h"
#include "gpu/spirv/remove.h"
#include "gpu/spirv/slide.h"
#include "gpu/spirv/solve.h"

namespace osteon::gpu {
namespace {

constexpr int kBuffers = 10;
constexpr std::uint32_t kPassCount = 16;
constexpr std::array<const char*, kPassCount> kPassNames{
    "contact_live", "place",        "reach", "contact", "place_again", "near",    "pick_balls", "pick_points",
    "planes",       "planes_shaft", "solve", "slide",   "engage",      "advance", "remove",     "clear"};

}  // namespace

void FrameProgram::Open(std::unique_ptr<Context> opened, bool time_passes) {
  context = std::move(opened);
  poll = context->info.kind != "cpu";
  command_pool =
      vk::raii::CommandPool(*context->device, vk::CommandPoolCreateInfo({}, context->queue_family));
  fence = vk::raii::Fence(*context->device, vk::FenceCreateInfo());
  const auto families = context->physical->getQueueFamilyProperties();
  if (!time_passes || families[context->queue_family].timestampValidBits == 0) return;
  stamp_period_ns = context->physical->getProperties().limits.timestampPeriod;
  stamps = vk::raii::QueryPool(*context->device,
                               vk::QueryPoolCreateInfo({}, vk::QueryType::eTimestamp, kPassCount + 1));
}

void FrameProgram::Build(const simulation::Tool& tool) {
  BuildPipelines(tool);
  Record();
}

void FrameProgram::Copy(const Buffer& from, const Buffer& to, vk::DeviceSize size) const {
  vk::raii::CommandBuffers once(*context->device, {*command_pool, vk::CommandBufferLevel::ePrimary, 1});
  once[0].begin(vk::CommandBufferBeginInfo(vk::CommandBufferUsageFlagBits::eOneTimeSubmit));
  once[0].copyBuffer(*from.buffer, *to.buffer, vk::BufferCopy(0, 0, size));
  once[0].end();
  const vk::CommandBuffer raw = *once[0];
  context->queue->submit(vk::SubmitInfo(nullptr, nullptr, raw));
  context->queue->waitIdle();
}

void FrameProgram::Write(const Buffer& buffer, const void* data, std::size_t size) const {
  if (size == 0) return;
  const Buffer staging = MakeBuffer(*context, size, Placement::kUpload);
  std::memcpy(staging.mapped, data, size);
  Copy(staging, buffer, size);
}

void FrameProgram::Read(const Buffer& buffer, void* data, std::size_t size) const {
  if (size == 0) return;
  const Buffer staging = MakeBuffer(*context, size, Placement::kReadBack);
  Copy(buffer, staging, size);
  std::memcpy(data, staging.mapped, size);
}

// Counts again what is left in each cluster of `count` balls or points: a state may give back what was cut.
void FrameProgram::BuildPipelines(const simulation::Tool& tool) {
  const vk::raii::Device& device = *context->device;
  std::vector<vk::DescriptorSetLayoutBinding> bindings;
  for (std::uint32_t i = 0; i < kBuffers; ++i)
    bindings.emplace_back(i, vk::DescriptorType::eStorageBuffer, 1, vk::ShaderStageFlagBits::eCompute);
  set_layout = vk::raii::DescriptorSetLayout(device, vk::DescriptorSetLayoutCreateInfo({}, bindings));
  layout = vk::raii::PipelineLayout(device, vk::PipelineLayoutCreateInfo({}, *set_layout));

  // specialization: numbers of clusters; which of the two kinds of planes; what a tool with a single cutting
  // ball saves
  struct Constants {
    uint ball_clusters, point_clusters;
    VkBool32 shaft_pass, sum_points;
    uint only_cutting;
  } constants{ClusterCount(ball_count), ClusterCount(point_count), VK_FALSE, VK_TRUE, 0};
  const auto cuts = [](const simulation::ToolBall& ball) { return ball.cutting; };
  if (std::count_if(tool.balls.begin(), tool.balls.end(), cuts) == 1) {
    constants.sum_points = VK_FALSE;
    constants.only_cutting =
        static_cast<uint>(std::find_if(tool.balls.begin(), tool.balls.end(), cuts) - tool.balls.begin());
  }
  const std::array<vk::SpecializationMapEntry, 5> entries{
      {{0, offsetof(Constants, ball_clusters), sizeof(uint)},
       {1, offsetof(Constants, point_clusters), sizeof(uint)},
       {2, offsetof(Constants, shaft_pass), sizeof(VkBool32)},
       {3, offsetof(Constants, sum_points), sizeof(VkBool32)},
       {4, offsetof(Constants, only_cutting), sizeof(uint)}}};
  const auto add = [&](const std::uint32_t* code, std::size_t bytes, const Constants& values) {
    const vk::SpecializationInfo specialization(static_cast<std::uint32_t>(entries.size()), entries.data(),
                                                sizeof(values), &values);
    const vk::raii::ShaderModule module(device, vk::ShaderModuleCreateInfo({}, bytes, code));
    const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module, "main",
                                                  &specialization);
    pipelines.emplace_back(device, nullptr, vk::ComputePipelineCreateInfo({}, stage, *layout));
  };
  add(kSpirv_contact_live, sizeof(kSpirv_contact_live), constants);
  add(kSpirv_place, sizeof(kSpirv_place), constants);
  add(kSpirv_reach, sizeof(kSpirv_reach), constants);
  add(kSpirv_contact, sizeof(kSpirv_contact), constants);
  add(kSpirv_place, sizeof(kSpirv_place), constants);
  add(kSpirv_near, sizeof(kSpirv_near), constants);
  add(kSpirv_pick_balls, sizeof(kSpirv_pick_balls), constants);
  add(kSpirv_pick_points, sizeof(kSpirv_pick_points), constants);
  add(kSpirv_planes, sizeof(kSpirv_planes), constants);
  Constants shaft = constants;
  shaft.shaft_pass = shaft.sum_points = VK_TRUE;
  add(kSpirv_planes, sizeof(kSpirv_planes), shaft);
  add(kSpirv_solve, sizeof(kSpirv_solve), constants);
  add(kSpirv_slide, sizeof(kSpirv_slide), constants);
  add(kSpirv_engage, sizeof(kSpirv_engage), constants);
  add(kSpirv_advance, sizeof(kSpirv_advance), constants);
  add(kSpirv_remove, sizeof(kSpirv_remove), constants);
  add(kSpirv_clear, sizeof(kSpirv_clear), constants);

  const vk::DescriptorPoolSize size(vk::DescriptorType::eStorageBuffer, kBuffers);
  pool = vk::raii::DescriptorPool(
      device, vk::DescriptorPoolCreateInfo(vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 1, size));
  sets = vk::raii::DescriptorSets(device, vk::DescriptorSetAllocateInfo(*pool, *set_layout));
  const std::array<const Buffer*, kBuffers> bound{
      &frame,     &balls,     &points,          &ball_clusters, &point_clusters,
      &path_list, &near_list, &near_point_list, &live_list,     &live_point_list};
  for (std::uint32_t i = 0; i < kBuffers; ++i) {
    const vk::DescriptorBufferInfo info(*bound[i]->buffer, 0, VK_WHOLE_SIZE);
    device.updateDescriptorSets(
        vk::WriteDescriptorSet(*sets[0], i, 0, vk::DescriptorType::eStorageBuffer, nullptr, info), nullptr);
  }
}

void FrameProgram::Record() {
  using Access = vk::AccessFlagBits;
  using Stage = vk::PipelineStageFlagBits;
  commands = vk::raii::CommandBuffers(*context->device, {*command_pool, vk::CommandBufferLevel::ePrimary, 1});
  const vk::raii::CommandBuffer& c = commands[0];
  const auto barrier = [&](vk::PipelineStageFlags from, vk::AccessFlags wrote, vk::PipelineStageFlags to,
                           vk::AccessFlags reads) {
    c.pipelineBarrier(from, to, {}, vk::MemoryBarrier(wrote, reads), nullptr, nullptr);
  };
  c.begin(vk::CommandBufferBeginInfo());
  const auto stamp = [&](std::uint32_t i) {
    if (stamp_period_ns > 0.0) c.writeTimestamp(Stage::eBottomOfPipe, *stamps, i);
  };
  if (stamp_period_ns > 0.0) c.resetQueryPool(*stamps, 0, kPassCount + 1);
  stamp(0);
  c.copyBuffer(*frame_in.buffer, *frame.buffer, vk::BufferCopy(0, 0, sizeof(Frame)));
  barrier(Stage::eTransfer, Access::eTransferWrite, Stage::eComputeShader,
          Access::eShaderRead | Access::eShaderWrite);
  c.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *layout, 0, *sets[0], nullptr);
  // in the order of the pipelines: a number of workgroups, or where the passes before have written it
  struct Launch {
    uint groups;
    vk::DeviceSize indirect;
    bool barrier;  // false where the next pass does not need this one's results
  };
  const auto indirect = [](std::size_t offset, bool wait) { return Launch{0, offset, wait}; };
  const std::array<Launch, kPassCount> launches{{indirect(offsetof(Frame, live_balls), true),
                                                 {1, 0, true},
                                                 indirect(offsetof(Frame, reach_groups), true),
                                                 indirect(offsetof(Frame, path_balls), true),
                                                 indirect(offsetof(Frame, place_groups), true),
                                                 indirect(offsetof(Frame, near_groups), true),
                                                 indirect(offsetof(Frame, near_balls), false),
                                                 indirect(offsetof(Frame, near_points), true),
                                                 indirect(offsetof(Frame, live_balls), false),
                                                 indirect(offsetof(Frame, shaft_balls), true),
                                                 {1, 0, true},
                                                 indirect(offsetof(Frame, live_balls), false),
                                                 indirect(offsetof(Frame, live_points), true),
                                                 {1, 0, true},
                                                 indirect(offsetof(Frame, live_balls), false),
                                                 indirect(offsetof(Frame, live_points), true)}};
  for (std::size_t i = 0; i < pipelines.size(); ++i) {
    c.bindPipeline(vk::PipelineBindPoint::eCompute, *pipelines[i]);
    if (launches[i].groups > 0)
      c.dispatch(launches[i].groups, 1, 1);
    else
      c.dispatchIndirect(*frame.buffer, launches[i].indirect);
    if (launches[i].barrier)
      barrier(
          Stage::eComputeShader, Access::eShaderWrite,
          Stage::eComputeShader | Stage::eDrawIndirect | Stage::eTransfer,
          Access::eShaderRead | Access::eShaderWrite | Access::eIndirectCommandRead | Access::eTransferRead);
    stamp(static_cast<std::uint32_t>(i) + 1);
  }
  c.copyBuffer(*frame.buffer, *frame_out.buffer, vk::BufferCopy(0, 0, sizeof(Frame)));
  barrier(Stage::eTransfer, Access::eTransferWrite, Stage::eHost, Access::eHostRead);
  c.end();
}

bool FrameProgram::Run(std::uint64_t timeout_ns) try {
  const vk::CommandBuffer raw = *commands[0];
  context->device->resetFences(*fence);
  context->queue->submit(vk::SubmitInfo(nullptr, nullptr, raw), *fence);
  if (poll) {
    // a GPU answers within tens of microseconds: asking is quicker than being woken
    for (int i = 0; i < 20'000; ++i)
      if (fence.getStatus() == vk::Result::eSuccess) return true;
  }
  return context->device->waitForFences(*fence, VK_TRUE, timeout_ns) == vk::Result::eSuccess;
} catch (const std::exception&) {
  return false;
}

std::vector<PassTime> FrameProgram::PassTimes() const {
  std::vector<PassTime> times;
  if (stamp_period_ns <= 0.0) return times;
  const auto [result, ticks] =
      stamps.getResults<std::uint64_t>(0, kPassCount + 1, (kPassCount + 1) * sizeof(std::uint64_t),
                                       sizeof(std::uint64_t), vk::QueryResultFlagBits::e64);
  if (result != vk::Result::eSuccess) return times;
  for (std::size_t i = 0; i < kPassCount; ++i)
    times.push_back({kPassNames[i], static_cast<double>(ticks[i + 1] - ticks[i]) * stamp_period_ns * 1e-9});
  return times;
}

}  // namespace osteon::gpu
