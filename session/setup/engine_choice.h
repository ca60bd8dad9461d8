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
/// Whether the engine is fast enough for wall time. "reference" is only for virtual time.
[[nodiscard]] bool KeepsUpWithWallTime(const std::string& engine);
/// The values of `--engine` for a command that runs in wall time.
[[nodiscard]] const std::vector<std::string>& WallTimeEngineNames();

/// A cutting engine that runs on this machine.
struct EngineChoice {
  std::string engine{"cpu"};  ///< "vulkan", "cpu" or "reference"
  std::string device{};       ///< Vulkan: part of the device's name; empty: the default device
  std::string reason{};       ///< why "auto" took this engine; empty if the user named the engine
};

/// Turns the values of `--engine` and `--device` into an engine. "auto" takes Vulkan if a device is named or
/// a GPU can run the cutting passes, else the CPU engine.
[[nodiscard]] EngineChoice ChooseEngine(const std::string& engine, const std::string& device);
/// Makes the same choice for a machine with these Vulkan devices, of which the first is the default. An error
/// instead of devices means that the machine has no Vulkan.
[[nodiscard]] EngineChoice ChooseEngine(
    const std::string& engine, const std::string& device,
    const tl::expected<std::vector<gpu::DeviceInfo>, std::string>& devices);

/// Whether the device is a GPU rather than a driver that computes on the CPU.
[[nodiscard]] bool IsGpu(const gpu::DeviceInfo& device);

/// Describes the choice in one line: "cpu on one thread, AVX-512 (--engine auto: no GPU …)".
/// @param device  the device of the engine that was made (CuttingEngine::device)
[[nodiscard]] std::string EngineText(const EngineChoice& choice, const std::string& device);

/// Options of an engine for studies. An engine that does not support an option ignores it.
struct EngineStudy {
  bool time_passes{false};  ///< measure how long each pass or stage of a frame takes
  bool brute_force{false};  ///< Vulkan: test all pairs of balls, without culling
};

/// Makes an engine. The error says that the machine has no such device, or that the engine can't hold bone
/// and tool.
[[nodiscard]] tl::expected<std::unique_ptr<simulation::CuttingEngine>, std::string> MakeEngine(
    const EngineChoice& choice, const simulation::Bone& bone, const simulation::Tool& tool, const Pose& X_WG,
    const simulation::CuttingParams& cutting, const EngineStudy& study = {});

/// Returns the number of bone balls that the engine's last frame worked on; the frame's time grows with it.
/// @param balls  number of balls of the whole bone, which is returned for an engine that does not count
[[nodiscard]] double ActiveBalls(const simulation::CuttingEngine& engine, std::size_t balls);

}  // namespace osteon::session
