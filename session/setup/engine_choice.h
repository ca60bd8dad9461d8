#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "gpu/context/devices.h"
#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/tools/tool.h"

namespace osteon::session {

/// The values of `--engine`, "auto" first.
[[nodiscard]] const std::vector<std::string>& EngineNames();
/// Whether the engine is fast enough for wall time. "reference" is for virtual time alone.
[[nodiscard]] bool KeepsUpWithWallTime(const std::string& engine);
/// The values of `--engine` of a command that runs in wall time.
[[nodiscard]] const std::vector<std::string>& WallTimeEngineNames();

/// A cutting engine that runs on this machine.
struct EngineChoice {
  std::string engine{"cpu"};  ///< "vulkan", "cpu" or "reference"
  std::string device{};       ///< Vulkan: part of the device's name; empty: the default device
  std::string reason{};       ///< why "auto" took it; empty where the user named the engine
};

/// Turns the values of `--engine` and `--device` into an engine. "auto" takes Vulkan where a device is named,
/// or where a GPU can run the cutting passes, and the CPU engine elsewhere.
[[nodiscard]] EngineChoice ChooseEngine(const std::string& engine, const std::string& device);
/// The same for a machine with these Vulkan devices, the default one first, or without Vulkan.
[[nodiscard]] EngineChoice ChooseEngine(
    const std::string& engine, const std::string& device,
    const tl::expected<std::vector<gpu::DeviceInfo>, std::string>& devices);

/// Whether the device is a GPU of this machine, and not a driver that computes on the processor.
[[nodiscard]] bool IsGpu(const gpu::DeviceInfo& device);

/// Describes the choice in one line: "cpu on one thread, AVX-512 (--engine auto: no GPU …)".
/// @param device  of the engine that was made
[[nodiscard]] std::string EngineText(const EngineChoice& choice, const std::string& device);

/// How a study runs an engine. An engine that has no such thing ignores it.
struct EngineStudy {
  bool time_passes{false};  ///< measure the passes or stages of a frame
  bool brute_force{false};  ///< Vulkan: without culling
};

/// @returns an error text where the machine has no such device, or the engine can't hold bone and tool.
[[nodiscard]] tl::expected<std::unique_ptr<simulation::CuttingEngine>, std::string> MakeEngine(
    const EngineChoice& choice, const simulation::Bone& bone, const simulation::Tool& tool, const Pose& X_WG,
    const simulation::CuttingParams& cutting, const EngineStudy& study = {});

/// Number of bone balls that the engine's last frame worked on, with which its time grows.
/// @param balls  of the whole bone: an engine that does not count works on all of them
[[nodiscard]] double ActiveBalls(const simulation::CuttingEngine& engine, std::size_t balls);

}  // namespace osteon::session
