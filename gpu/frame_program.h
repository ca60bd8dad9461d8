#pragma once

// Inside gpu only: this header brings vulkan_raii.hpp.

#include <memory>
#include <vector>

#include "gpu/context.h"
#include "gpu/shaders/layout.h"
#include "gpu/vulkan_engine.h"
#include "simulation/tool.h"

namespace osteon::gpu {

/// Clusters of kGroupSize items.
[[nodiscard]] inline uint ClusterCount(std::size_t count) {
  return static_cast<uint>((count + kGroupSize - 1) / kGroupSize);
}

/// A frame's passes on the device: buffers, pipelines, and the command buffer that is recorded once. Knows
/// nothing of poses. Order of use: Open; make and fill the buffers; Build; Run for each frame. Methods but
/// Run throw vk::SystemError.
struct FrameProgram {
  std::unique_ptr<Context> context;
  std::size_t ball_count{0}, point_count{0};
  Buffer frame, frame_in, frame_out, balls, points, ball_clusters, point_clusters, path_list, near_list,
      near_point_list, live_list, live_point_list;

  void Open(std::unique_ptr<Context> opened, bool time_passes);
  void Build(const simulation::Tool& tool);
  /// One submit of the recorded passes, from frame_in to frame_out. False where the device is lost or the
  /// time is up.
  bool Run(std::uint64_t timeout_ns);

  /// Between host memory and a buffer of the device; waits.
  void Write(const Buffer& buffer, const void* data, std::size_t size) const;
  void Read(const Buffer& buffer, void* data, std::size_t size) const;

  /// Of the last run; empty where passes are not timed.
  [[nodiscard]] std::vector<PassTime> PassTimes() const;

 private:
  void BuildPipelines(const simulation::Tool& tool);
  void Record();
  void Copy(const Buffer& from, const Buffer& to, vk::DeviceSize size) const;

  vk::raii::DescriptorSetLayout set_layout{nullptr};
  vk::raii::PipelineLayout layout{nullptr};
  std::vector<vk::raii::Pipeline> pipelines;
  vk::raii::DescriptorPool pool{nullptr};
  vk::raii::DescriptorSets sets{nullptr};
  vk::raii::CommandPool command_pool{nullptr};
  vk::raii::CommandBuffers commands{nullptr};
  vk::raii::Fence fence{nullptr};
  vk::raii::QueryPool stamps{nullptr};
  double stamp_period_ns{0.0};  ///< 0: the device has no timestamps
  bool poll{false};             ///< ask for the fence instead of waiting: quicker on a GPU
};

}  // namespace osteon::gpu
