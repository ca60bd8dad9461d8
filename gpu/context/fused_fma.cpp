#include "gpu/context/fused_fma.h"

#include <cmath>
#include <cstdint>
#include <random>
#include <span>

#include "gpu/spirv/fused_fma.h"

namespace osteon::gpu {
namespace {

// A product a b, and the rounding error that the device finds for it. The layout is that of
// shaders/fused_fma.comp.
struct FmaTrial {
  float a, b, found;
};
constexpr std::uint32_t kTrials = 1024, kGroup = 64;  // number of trials in all and in a workgroup

// Runs the shader on all trials, and waits until their `found` is in the buffer.
void Compute(const Context& context, const Buffer& trials) {
  const vk::raii::Device& device = *context.device;
  const vk::DescriptorSetLayoutBinding binding(0, vk::DescriptorType::eStorageBuffer, 1,
                                               vk::ShaderStageFlagBits::eCompute);
  const vk::raii::DescriptorSetLayout set_layout(device, vk::DescriptorSetLayoutCreateInfo({}, binding));
  const vk::raii::PipelineLayout layout(device, vk::PipelineLayoutCreateInfo({}, *set_layout));
  const vk::raii::ShaderModule module(
      device, vk::ShaderModuleCreateInfo({}, sizeof(kSpirv_fused_fma), kSpirv_fused_fma));
  const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module, "main");
  const vk::raii::Pipeline pipeline(device, nullptr, vk::ComputePipelineCreateInfo({}, stage, *layout));
  const vk::DescriptorPoolSize size(vk::DescriptorType::eStorageBuffer, 1);
  const vk::raii::DescriptorPool pool(
      device, vk::DescriptorPoolCreateInfo(vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 1, size));
  const vk::raii::DescriptorSets sets(device, vk::DescriptorSetAllocateInfo(*pool, *set_layout));
  const vk::DescriptorBufferInfo bound(*trials.buffer, 0, VK_WHOLE_SIZE);
  device.updateDescriptorSets(
      vk::WriteDescriptorSet(*sets[0], 0, 0, vk::DescriptorType::eStorageBuffer, nullptr, bound), nullptr);

  const vk::raii::CommandPool commands(device, vk::CommandPoolCreateInfo({}, context.queue_family));
  const vk::raii::CommandBuffers once(device, {*commands, vk::CommandBufferLevel::ePrimary, 1});
  once[0].begin(vk::CommandBufferBeginInfo(vk::CommandBufferUsageFlagBits::eOneTimeSubmit));
  once[0].bindDescriptorSets(vk::PipelineBindPoint::eCompute, *layout, 0, *sets[0], nullptr);
  once[0].bindPipeline(vk::PipelineBindPoint::eCompute, *pipeline);
  once[0].dispatch(kTrials / kGroup, 1, 1);
  once[0].pipelineBarrier(vk::PipelineStageFlagBits::eComputeShader, vk::PipelineStageFlagBits::eHost, {},
                          vk::MemoryBarrier(vk::AccessFlagBits::eShaderWrite, vk::AccessFlagBits::eHostRead),
                          nullptr, nullptr);
  once[0].end();
  const vk::CommandBuffer raw = *once[0];
  context.queue->submit(vk::SubmitInfo(nullptr, nullptr, raw));
  context.queue->waitIdle();
}

}  // namespace

bool HasFusedFma(const Context& context) {
  const Buffer buffer = MakeBuffer(context, kTrials * sizeof(FmaTrial), Placement::kReadBack);
  const std::span trials(static_cast<FmaTrial*>(buffer.mapped), kTrials);
  std::mt19937 random(1);
  // random, of either sign, with a magnitude between 2^-20 and 2^21
  const auto factor = [&] {
    const float size =
        std::ldexp(1.0f + static_cast<float>(random() >> 9) * 0x1p-23f, static_cast<int>(random() % 41) - 20);
    return random() % 2 == 0 ? size : -size;
  };
  for (FmaTrial& trial : trials) trial = {factor(), factor(), NAN};
  Compute(context, buffer);
  // if fma() rounds only once, the device finds exactly the product's rounding error
  for (const FmaTrial& trial : trials)
    if (trial.found != std::fma(trial.a, trial.b, -(trial.a * trial.b))) return false;
  return true;
}

}  // namespace osteon::gpu
