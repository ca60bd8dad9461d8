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
  std::size_t split_events{0}, uploads{0}, blocks{0};  ///< capacities for split balls; 0: no ball is split
  std::size_t packed_pairs{0};                         ///< packed pairs of all list entries together
  bool contact_sphere{false};                          ///< only the tool ball that touches first cuts
};

enum class FrameMode : std::size_t {
  kLists,           ///< uses the lists of an earlier frame
  kListsRefreshed,  ///< uses the lists of an earlier frame, after measuring their packed pairs again at the
                    ///< proxy
  kListsAtProxy,    ///< builds the lists at the proxy
  kListsAtContact,  ///< searches first contact on the whole path and builds the lists there
  kFlush,           ///< no frame: writes the lists' balls back to the buffer of all balls
};

/// A frame's passes on the device: buffers, pipelines and command buffers. They do not depend on poses, so
/// they are made once. Order of use: fill the buffers, then Run for each frame. Methods other than Run may
/// throw vk::SystemError.
class FrameProgram {
 public:
  /// Reason why the device cannot hold these buffers or fulfil the overrides; empty if it can.
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
  /// Returns the host memory of a buffer that the host fills before a frame (kBindTool, kBindClusterPairs,
  /// kBindToolRefs, kBindUploads).
  template <class T>
  [[nodiscard]] T* host(uint binding) {
    return static_cast<T*>(buffers_[binding].mapped);
  }

  /// Runs one frame in one submit. Returns false if the device is lost or the frame takes longer than
  /// `timeout_ns`.
  bool Run(const Frame& frame, FrameMode mode, std::uint64_t timeout_ns);

  /// Returns true once the last run has ended; waits at most `timeout_ns` for that.
  [[nodiscard]] bool IsIdle(std::uint64_t timeout_ns) const;

  /// Write and Read copy between host memory and a buffer, from the buffer's byte `place` on, and wait for
  /// the copy's end.
  void Write(uint binding, const void* data, std::size_t size, std::size_t place = 0) const;
  void Read(uint binding, void* data, std::size_t size) const;

  /// Times of the last run's passes; empty where passes are not timed.
  [[nodiscard]] std::vector<PassTime> PassTimes() const;
  [[nodiscard]] const Context& context() const { return *context_; }
  /// Whether the driver of a GPU has just compiled the passes, judged by the time that creating the pipelines
  /// took. NVIDIA's compiler takes seconds, and the code of this first compilation is three times as slow as
  /// the code that the driver's cache provides later. An open device keeps the slow code; only a newly opened
  /// device gets the faster code.
  [[nodiscard]] bool compiled() const { return context_->info.kind != "cpu" && pipelines_s_ > kCompiled_s; }
  /// Whether the passes are built for a GPU.
  [[nodiscard]] bool for_gpu() const { return gpu_; }
  /// Invocations of a workgroup: kGroupSize on a GPU, fewer on a processor.
  [[nodiscard]] uint lanes() const {
    return gpu_ ? kGroupSize : std::max<uint>(kProcessorLanes, subgroup_size_);
  }
  /// Largest number of workgroups of a pass along x. If there is more work, each workgroup loops.
  [[nodiscard]] uint max_workgroups() const { return max_workgroups_; }
  [[nodiscard]] uint WithinLimit(std::size_t workgroups) const {
    return static_cast<uint>(std::min<std::size_t>(workgroups, max_workgroups_));
  }

 private:
  static constexpr uint kProcessorLanes = 8;  // smallest number of invocations of a workgroup on a processor
  static constexpr double kCompiled_s = 1.0;  // measured: 0.1 to 0.3 s from the cache, 3.5 to 7 s without
  // The outputs of a pass that the next pass needs, so that a barrier must wait for them: none, the results,
  // or the results and the number of workgroups of the next pass.
  enum class NextPassNeeds { kNothing, kResults, kGroupCount };
  struct Pass {
    const char* name;
    vk::raii::Pipeline pipeline;
    /// Offset in Frame of the pass's DispatchArgs; kOneWorkgroup: the pass has one workgroup.
    std::size_t groups;
    NextPassNeeds next_needs;
    /// Divisor of the number of workgroups in the DispatchArgs, for passes with larger workgroups.
    uint share{1};
  };
  static constexpr std::size_t kOneWorkgroup = ~std::size_t{0};

  // The frame with the results of the passes, not decoded.
  [[nodiscard]] const Frame& raw_result() const {
    return gpu_ ? readback().frame : *static_cast<const Frame*>(frame_in_.mapped);
  }
  [[nodiscard]] const Readback& readback() const {
    return *static_cast<const Readback*>(buffers_[kBindReadback].mapped);
  }
  // Submits the mode's commands and waits for their results. False if they do not arrive within the timeout.
  [[nodiscard]] bool RunCommands(FrameMode mode, std::uint64_t timeout_ns);
  void MakeBuffers();
  [[nodiscard]] const Buffer& FrameBuffer() const { return copies_in_ ? buffers_[kBindFrame] : frame_in_; }
  void MakePipelines(bool fused_fma);
  // If `known` is given, the numbers of workgroups are recorded as constants from it, which is faster than
  // reading them from device memory.
  [[nodiscard]] vk::raii::CommandBuffer Record(const std::vector<std::size_t>& passes,
                                               const Frame* known) const;
  void RecordLists(const Frame& frame);
  [[nodiscard]] bool AwaitFence(std::uint64_t timeout_ns);
  [[nodiscard]] bool AwaitReadback(std::uint64_t timeout_ns);
  void Copy(const Buffer& from, const Buffer& to, vk::DeviceSize size, vk::DeviceSize place) const;

  std::unique_ptr<Context> context_;
  ProgramSizes sizes_;
  std::array<Buffer, kBindings> buffers_;
  Buffer frame_in_;  // input: the frame as the host writes it
  bool gpu_{false};
  uint subgroup_size_{0}, max_workgroups_{0}, bone_bits_{kMinBoneBits};
  /// Request subgroup_size_ explicitly, because the driver would choose another size.
  bool asks_subgroup_size_{false};
  double pipelines_s_{0.0};  // time for creating the pipelines
  bool copies_in_{false};    ///< the host cannot write to the memory that the passes read, so each run copies
                             ///< the frame there
  uint sequence_{0};         ///< number of the last readback
  Frame decoded_{};          ///< for a device without doubles: the result converted to doubles
  std::vector<vk::raii::BufferView> views_;
  vk::raii::DescriptorSetLayout set_layout_{nullptr};
  vk::raii::PipelineLayout layout_{nullptr};
  vk::raii::DescriptorPool pool_{nullptr};
  vk::raii::DescriptorSets sets_{nullptr};
  vk::raii::CommandPool command_pool_{nullptr};
  std::vector<Pass> passes_;
  std::array<std::vector<std::size_t>, 5> run_passes_;  // indices into passes_, for each FrameMode
  std::vector<vk::raii::CommandBuffer> commands_;
  std::array<DispatchArgs, 3> recorded_{};  // numbers of workgroups in the last recording of kLists
  FrameMode last_mode_{FrameMode::kLists};
  vk::raii::Fence fence_{nullptr};
  vk::raii::QueryPool stamps_{nullptr};
  double stamp_period_ns_{0.0};  ///< 0: passes are not timed
  FencePolicy policy_{FencePolicy::kWait};
};

}  // namespace osteon::gpu
