#pragma once

// Inside gpu only: this header brings vulkan_raii.hpp.

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <vector>

#include "gpu/context.h"
#include "gpu/shaders/bin_key.h"
#include "gpu/shaders/layout.h"
#include "gpu/vulkan_engine.h"

namespace osteon::gpu {

/// How many of what a frame's buffers hold.
struct ProgramSizes {
  std::size_t balls{0}, points{0}, ball_clusters{0}, point_clusters{0};
  std::size_t tool_balls{0}, cutters{0}, tool_refs{0}, materials{1};
  std::size_t live{0};                             ///< entries of each list of what the tool can meet
  std::size_t requests{0}, uploads{0}, blocks{0};  ///< of balls that are split; 0: none is
  std::size_t spans{0};                            ///< tool balls of all live balls and points together
  bool contact_sphere{false};                      ///< the tool ball that touches first cuts alone
};

enum class FrameMode : std::size_t {
  kLists,           ///< with the lists of an earlier frame
  kListsRefreshed,  ///< the same, the lists' words made anew where the frame begins
  kListsAtProxy,    ///< with lists made where the frame begins
  kListsAtContact,  ///< with lists made at first contact, found on the whole way
  kFlush,           ///< no frame: the lists' balls go back to where they are read from
};

/// A frame's passes on the device: buffers, pipelines, and the command buffers, recorded once. Knows nothing
/// of poses. Order of use: fill the buffers; Run for each frame. Methods but Run throw vk::SystemError.
class FrameProgram {
 public:
  /// Empty where the device has room for all that and can do what the overrides ask; else the reason, in
  /// words.
  [[nodiscard]] static std::string Refusal(const Context& context, const ProgramSizes& sizes,
                                           const VulkanOverrides& overrides);

  FrameProgram(std::unique_ptr<Context> opened, const ProgramSizes& sizes, const VulkanParams& params);

  /// What the last Run has found. Host memory.
  [[nodiscard]] const Frame& result() const {
    return gpu_ ? report().frame : *static_cast<const Frame*>(frame_in_.mapped);
  }
  /// Host memory of a buffer that is written before each frame: kBindTool, kBindItems, kBindToolRefs;
  /// or that the host and the device share: kBindRequests, kBindUploads, kBindBlocks.
  template <class T>
  [[nodiscard]] T* host(uint binding) {
    return static_cast<T*>(buffers_[binding].mapped);
  }

  /// One submit. False where the device is lost or the time is up.
  bool Run(const Frame& frame, FrameMode mode, std::uint64_t timeout_ns);

  /// Whether the last run is over; waits for it that long.
  [[nodiscard]] bool IsIdle(std::uint64_t timeout_ns) const;

  /// Between host memory and a buffer (from byte `place` on); waits.
  void Write(uint binding, const void* data, std::size_t size, std::size_t place = 0) const;
  void Read(uint binding, void* data, std::size_t size) const;

  /// Of the last run; empty where passes are not timed.
  [[nodiscard]] std::vector<PassTime> PassTimes() const;
  [[nodiscard]] const Context& context() const { return *context_; }
  /// Whether the driver of a GPU compiled the passes just now, by the time that it took. NVIDIA's
  /// compiles in seconds to code that is three times as slow as what it has in its cache afterwards, and what
  /// it has compiled once a device keeps: only another device has the better.
  [[nodiscard]] bool compiled() const { return context_->info.kind != "cpu" && pipelines_s_ > kCompiled_s; }
  /// Whether the passes are those for a GPU.
  [[nodiscard]] bool for_gpu() const { return gpu_; }
  /// Invocations of a workgroup: kGroupSize for a GPU, fewer for a processor.
  [[nodiscard]] uint lanes() const {
    return gpu_ ? kGroupSize : std::max<uint>(kProcessorLanes, subgroup_size_);
  }
  /// Workgroups of a pass along x, as many as the device takes: what more are asked for go round.
  [[nodiscard]] uint max_workgroups() const { return max_workgroups_; }
  [[nodiscard]] uint WithinLimit(std::size_t workgroups) const {
    return static_cast<uint>(std::min<std::size_t>(workgroups, max_workgroups_));
  }

 private:
  static constexpr uint kProcessorLanes = 8;
  static constexpr double kCompiled_s = 1.0;  // seen: .1 to .3 s from the cache, 3.5 to 7 s without
  // What the next pass needs of a pass: nothing, what it wrote, or also how many workgroups it is to have.
  enum class Then { kNothing, kReads, kGroups };
  struct Pass {
    const char* name;
    vk::raii::Pipeline pipeline;
    std::size_t groups;  ///< offset in Frame of its indirect arguments; kOne: one workgroup
    Then then;
    uint share{1};  ///< of the workgroups that the arguments tell, one in so many is enough
  };
  static constexpr std::size_t kOne = ~std::size_t{0};

  [[nodiscard]] const Report& report() const {
    return *static_cast<const Report*>(buffers_[kBindReport].mapped);
  }
  void MakeBuffers();
  [[nodiscard]] const Buffer& FrameBuffer() const { return copies_in_ ? buffers_[kBindFrame] : frame_in_; }
  void MakePipelines();
  // With `known` the sizes of dispatches are told here, which is quicker than from the device's memory.
  [[nodiscard]] vk::raii::CommandBuffer Record(const std::vector<std::size_t>& passes,
                                               const Frame* known) const;
  void RecordLists(const Frame& frame);
  [[nodiscard]] bool AwaitFence(std::uint64_t timeout_ns);
  [[nodiscard]] bool AwaitReport(std::uint64_t timeout_ns);
  void Copy(const Buffer& from, const Buffer& to, vk::DeviceSize size, vk::DeviceSize place) const;

  std::unique_ptr<Context> context_;
  ProgramSizes sizes_;
  std::array<Buffer, kBindings> buffers_;
  Buffer frame_in_;
  bool gpu_{false};
  uint subgroup_size_{0}, max_workgroups_{0}, bone_bits_{kMinBoneBits};
  bool asks_subgroup_size_{false};  ///< of the driver, which would take another one
  double pipelines_s_{0.0};         // that making them took
  bool copies_in_{false};           ///< the host can't write where the passes read
  uint sequence_{0};                ///< of the last report
  std::vector<vk::raii::BufferView> views_;
  vk::raii::DescriptorSetLayout set_layout_{nullptr};
  vk::raii::PipelineLayout layout_{nullptr};
  vk::raii::DescriptorPool pool_{nullptr};
  vk::raii::DescriptorSets sets_{nullptr};
  vk::raii::CommandPool command_pool_{nullptr};
  std::vector<Pass> passes_;
  std::array<std::vector<std::size_t>, 5> run_passes_;  // by mode
  std::vector<vk::raii::CommandBuffer> commands_;
  std::array<Groups, 3> recorded_{};  // workgroups in kLists' commands
  FrameMode last_mode_{FrameMode::kLists};
  vk::raii::Fence fence_{nullptr};
  vk::raii::QueryPool stamps_{nullptr};
  double stamp_period_ns_{0.0};  ///< 0: passes are not timed
  FencePolicy policy_{FencePolicy::kWait};
};

}  // namespace osteon::gpu
