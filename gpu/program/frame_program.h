#pragma once

// For files of gpu/ only: this header includes vulkan_raii.hpp.

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

#include "gpu/context/context.h"
#include "gpu/engine/vulkan_engine.h"
#include "gpu/shaders/bin_key.h"
#include "gpu/shaders/layout.h"

namespace osteon::gpu {

/// Numbers of elements in a frame's buffers.
struct ProgramSizes {
  std::size_t balls{0}, points{0}, ball_clusters{0}, point_clusters{0};
  std::size_t tool_balls{0}, cutters{0}, tool_refs{0}, materials{1};
  std::size_t live{0};  ///< capacity of each list of balls or points near the tool
  std::size_t split_events{0}, uploads{0}, blocks{0};  ///< for split balls; 0: no ball is split
  std::size_t packed_pairs{0};                         ///< packed pairs of all list entries together
  bool contact_sphere{false};                          ///< only the tool ball that touches first cuts
};

enum class FrameMode : std::size_t {
  kLists,           ///< uses the lists of an earlier frame
  kListsRefreshed,  ///< uses the lists of an earlier frame, with their packed pairs measured anew at the
                    ///< proxy
  kListsAtProxy,    ///< builds the lists at the proxy
  kListsAtContact,  ///< builds the lists at first contact, which is searched on the whole path
  kFlush,           ///< no frame: writes the lists' balls back to the buffer that they came from
};

/// A frame's passes on the device: buffers, pipelines, and the command buffers, recorded once. Independent of
/// poses. Order of use: fill the buffers; Run for each frame. Methods other than Run throw vk::SystemError.
class FrameProgram {
 public:
  /// Reason why the device cannot hold these buffers or fulfil the overrides; empty where it can.
  [[nodiscard]] static std::string Refusal(const Context& context, const ProgramSizes& sizes,
                                           const VulkanOverrides& overrides);

  FrameProgram(std::unique_ptr<Context> opened, const ProgramSizes& sizes, const VulkanParams& params);

  /// Result of the last Run. Host memory.
  [[nodiscard]] const Frame& result() const {
    return !HasDoubles(context_->arithmetic) ? decoded_ : raw_result();
  }
  /// The last Run's events of split balls, in any order. Host memory.
  [[nodiscard]] std::span<const SplitEvent> split_events() const {
    return {static_cast<const SplitEvent*>(buffers_[kBindSplitEvents].mapped),
            std::min<std::size_t>(result().split_event_count, sizes_.split_events)};
  }
  /// Host memory of a buffer that is written before a frame (kBindTool, kBindClusterPairs, kBindToolRefs,
  /// kBindUploads).
  template <class T>
  [[nodiscard]] T* host(uint binding) {
    return static_cast<T*>(buffers_[binding].mapped);
  }

  /// Runs one frame in one submit. False where the device is lost or the time is up.
  bool Run(const Frame& frame, FrameMode mode, std::uint64_t timeout_ns);

  /// True where the last run is over; waits at most `timeout_ns` for it.
  [[nodiscard]] bool IsIdle(std::uint64_t timeout_ns) const;

  /// Copies between host memory and a buffer (from byte `place` on); waits.
  void Write(uint binding, const void* data, std::size_t size, std::size_t place = 0) const;
  void Read(uint binding, void* data, std::size_t size) const;

  /// Times of the last run's passes; empty where passes are not timed.
  [[nodiscard]] std::vector<PassTime> PassTimes() const;
  [[nodiscard]] const Context& context() const { return *context_; }
  /// Whether the driver of a GPU has just compiled the passes, judged by the time that it took. NVIDIA's
  /// compiler takes seconds, and its first code is three times as slow as that from its cache later. A device
  /// keeps the code that it compiled: only a new device gets the faster code.
  [[nodiscard]] bool compiled() const { return context_->info.kind != "cpu" && pipelines_s_ > kCompiled_s; }
  /// True where the passes are built for a GPU.
  [[nodiscard]] bool for_gpu() const { return gpu_; }
  /// Invocations of a workgroup: kGroupSize on a GPU, fewer on a processor.
  [[nodiscard]] uint lanes() const {
    return gpu_ ? kGroupSize : std::max<uint>(kProcessorLanes, subgroup_size_);
  }
  /// Largest number of workgroups of a pass along x. Further work loops over them.
  [[nodiscard]] uint max_workgroups() const { return max_workgroups_; }
  [[nodiscard]] uint WithinLimit(std::size_t workgroups) const {
    return static_cast<uint>(std::min<std::size_t>(workgroups, max_workgroups_));
  }

 private:
  static constexpr uint kProcessorLanes = 8;  // smallest workgroup on a processor
  static constexpr double kCompiled_s = 1.0;  // measured: 0.1 to 0.3 s from the cache, 3.5 to 7 s without
  // What the next pass needs of a pass, and a barrier must wait for: nothing, its results, or also the number
  // of workgroups that it has computed for the next pass.
  enum class NextPassNeeds { kNothing, kResults, kGroupCount };
  struct Pass {
    const char* name;
    vk::raii::Pipeline pipeline;
    std::size_t groups;  ///< offset in Frame of its indirect arguments; kOneWorkgroup: one workgroup
    NextPassNeeds next_needs;
    uint share{1};  ///< divisor of the number of workgroups in the arguments
  };
  static constexpr std::size_t kOneWorkgroup = ~std::size_t{0};

  // The frame as the passes left it.
  [[nodiscard]] const Frame& raw_result() const {
    return gpu_ ? readback().frame : *static_cast<const Frame*>(frame_in_.mapped);
  }
  [[nodiscard]] const Readback& readback() const {
    return *static_cast<const Readback*>(buffers_[kBindReadback].mapped);
  }
  // Submits the mode's commands and waits for their results. False when the time is up.
  [[nodiscard]] bool RunCommands(FrameMode mode, std::uint64_t timeout_ns);
  void MakeBuffers();
  [[nodiscard]] const Buffer& FrameBuffer() const { return copies_in_ ? buffers_[kBindFrame] : frame_in_; }
  void MakePipelines(bool fused_fma);
  // With `known`, the sizes of dispatches are recorded as constants, which is faster than reading them from
  // device memory.
  [[nodiscard]] vk::raii::CommandBuffer Record(const std::vector<std::size_t>& passes,
                                               const Frame* known) const;
  void RecordLists(const Frame& frame);
  [[nodiscard]] bool AwaitFence(std::uint64_t timeout_ns);
  [[nodiscard]] bool AwaitReadback(std::uint64_t timeout_ns);
  void Copy(const Buffer& from, const Buffer& to, vk::DeviceSize size, vk::DeviceSize place) const;

  std::unique_ptr<Context> context_;
  ProgramSizes sizes_;
  std::array<Buffer, kBindings> buffers_;
  Buffer frame_in_;  // the frame as the host writes it
  bool gpu_{false};
  uint subgroup_size_{0}, max_workgroups_{0}, bone_bits_{kMinBoneBits};
  bool asks_subgroup_size_{false};  ///< explicitly, where the driver would choose another size
  double pipelines_s_{0.0};         // time for creating the pipelines
  bool copies_in_{false};           ///< the host cannot write to the memory that the passes read
  uint sequence_{0};                ///< number of the last readback
  Frame decoded_{};                 ///< without doubles on the device: the result, with doubles
  std::vector<vk::raii::BufferView> views_;
  vk::raii::DescriptorSetLayout set_layout_{nullptr};
  vk::raii::PipelineLayout layout_{nullptr};
  vk::raii::DescriptorPool pool_{nullptr};
  vk::raii::DescriptorSets sets_{nullptr};
  vk::raii::CommandPool command_pool_{nullptr};
  std::vector<Pass> passes_;
  std::array<std::vector<std::size_t>, 5> run_passes_;  // indices into passes_ of each FrameMode
  std::vector<vk::raii::CommandBuffer> commands_;
  std::array<DispatchArgs, 3> recorded_{};  // workgroups in the recorded commands of kLists
  FrameMode last_mode_{FrameMode::kLists};
  vk::raii::Fence fence_{nullptr};
  vk::raii::QueryPool stamps_{nullptr};
  double stamp_period_ns_{0.0};  ///< 0: passes are not timed
  FencePolicy policy_{FencePolicy::kWait};
};

}  // namespace osteon::gpu
