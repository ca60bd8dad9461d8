#include "session/setup/engine_choice.h"

#include <stdexcept>

#include <fmt/format.h>

#include "gpu/engine/vulkan_engine.h"
#include "simulation/engine/reference_engine.h"
#include "simulation/engine_cpu/cpu_engine.h"

namespace osteon::session {

const std::vector<std::string>& EngineNames() {
  static const std::vector<std::string> names{"auto", "vulkan", "cpu", "reference"};
  return names;
}

bool KeepsUpWithWallTime(const std::string& engine) { return engine != "reference"; }

const std::vector<std::string>& WallTimeEngineNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> fast = EngineNames();
    std::erase_if(fast, [](const std::string& name) { return !KeepsUpWithWallTime(name); });
    return fast;
  }();
  return names;
}

bool IsGpu(const gpu::DeviceInfo& device) { return device.kind == "discrete" || device.kind == "integrated"; }

EngineChoice ChooseEngine(const std::string& engine, const std::string& device,
                          const tl::expected<std::vector<gpu::DeviceInfo>, std::string>& devices) {
  if (engine != "auto") return {.engine = engine, .device = device};
  if (!device.empty()) return {.engine = "vulkan", .device = device, .reason = "--device names a device"};
  if (!devices) return {.engine = "cpu", .reason = "Vulkan has no device here"};
  std::string refused;  // the unsuitable devices, and why
  for (const gpu::DeviceInfo& found : *devices) {
    const bool is_gpu = IsGpu(found);
    // of all devices that are not refused, the engine opens the first
    if (is_gpu && found.refusal.empty()) return {.engine = "vulkan", .reason = "the device is a GPU"};
    refused += fmt::format("{}{} {}", refused.empty() ? "" : "; ", found.name,
                           is_gpu ? "can't run the passes: " + found.refusal : "computes on the processor");
  }
  return {.engine = "cpu", .reason = "no GPU for Vulkan: " + (refused.empty() ? "no device" : refused)};
}

EngineChoice ChooseEngine(const std::string& engine, const std::string& device) {
  if (engine != "auto" || !device.empty())
    return ChooseEngine(engine, device, std::vector<gpu::DeviceInfo>());
  return ChooseEngine(engine, device, gpu::ListDevices());
}

std::string EngineText(const EngineChoice& choice, const std::string& device) {
  std::string text = fmt::format("{} on {}", choice.engine, device);
  if (!choice.reason.empty()) text += fmt::format(" (--engine auto: {})", choice.reason);
  return text;
}

tl::expected<std::unique_ptr<simulation::CuttingEngine>, std::string> MakeEngine(
    const EngineChoice& choice, const simulation::Bone& bone, const simulation::Tool& tool, const Pose& X_WG,
    const simulation::CuttingParams& cutting, const EngineStudy& study) {
  try {
    if (choice.engine == "reference")
      return std::make_unique<simulation::ReferenceEngine>(bone, tool, X_WG, cutting);
    if (choice.engine == "cpu")
      return std::make_unique<simulation::CpuEngine>(bone, tool, X_WG, cutting,
                                                     simulation::CpuParams{.time_stages = study.time_passes});
  } catch (const std::invalid_argument& error) {
    return tl::make_unexpected(std::string(error.what()));
  }
  auto made = gpu::VulkanEngine::Create(
      bone, tool, X_WG, cutting,
      {.device = choice.device, .time_passes = study.time_passes, .brute_force = study.brute_force});
  if (!made) return tl::make_unexpected(made.error());
  return std::unique_ptr<simulation::CuttingEngine>(std::move(*made));
}

double ActiveBalls(const simulation::CuttingEngine& engine, std::size_t balls) {
  if (const auto* vulkan = dynamic_cast<const gpu::VulkanEngine*>(&engine))
    return static_cast<double>(vulkan->LastFrameStats().active_balls);
  if (const auto* cpu = dynamic_cast<const simulation::CpuEngine*>(&engine))
    return static_cast<double>(cpu->LastFrameStats().listed_balls);
  return static_cast<double>(balls);
}

}  // namespace osteon::session
