#pragma once

// Inside gpu only: this header brings vulkan_raii.hpp.

#include <array>
#include <cstring>
#include <memory>
#include <vector>

#include "gpu/context.h"
#include "gpu/shaders/layout.h"
#include "gpu/vulkan_engine.h"

namespace osteon::gpu {

/// How many of what a frame's buffers hold.
struct ProgramSizes {
  std::size_t balls{0}, points{0}, ball_clusters{0}, point_clusters{0};
  std::size_t tool_balls{0}, cutters{0}, tool_groups{0}, group_refs{0};
  std::size_t live{0};                             ///< entries of each list of what the tool can meet
  std::size_t requests{0}, uploads{0}, blocks{0};  ///< of balls that are split; 0: none is
  std::size_t spans{0};                            ///< tool balls of all live balls and points together
};

enum class FrameMode : std::size_t {
  kLists,           ///< with the lists of an earlier frame
  kListsAtProxy,    ///< with lists made where the frame begins
  kListsAtContact,  ///< with lists made at first contact, found on the whole way
  kFlush,           ///< no frame: the lists' balls go back to where they are read from
};

/// A frame's passes on the device: buffers, pipelines, and four command buffers that are recorded once.
/// Knows nothing of poses. Order of use: Open; fill the buffers; Run for each frame. Methods but Run throw
/// vk::SystemError.
///
///     with the lists of an earlier frame                    contact ─▶ planes ─▶ solve ─▶ slide, engage ─▶
///     remove, clear with lists made anew      path contact ─▶ pick balls, points ─▶ planes ─▶ …
class FrameProgram {
 public:
  /// Empty where the device has room for all that; else the reason, in words.
  [[nodiscard]] static std::string Refusal(const Context& context, const ProgramSizes& sizes);

  FrameProgram(std::unique_ptr<Context> opened, const ProgramSizes& sizes, const VulkanParams& params);

  /// The frame that the next Run works on, and after it what it has found. Host memory.
  [[nodiscard]] Frame& frame() { return *static_cast<Frame*>(frame_in_.mapped); }
  [[nodiscard]] const Frame& result() const { return *static_cast<const Frame*>(frame_out_->mapped); }
  /// Host memory of a buffer that is written before each frame: kBindTool, kBindItems, kBindGroupRefs;
  /// or that the host and the device share: kBindRequests, kBindUploads, kBindBlocks.
  template <class T>
  [[nodiscard]] T* host(uint binding) {
    return static_cast<T*>(buffers_[binding].mapped);
  }

  /// One submit. False where the device is lost or the time is up.
  bool Run(FrameMode mode, std::uint64_t timeout_ns);

  /// Whether the last run is over; waits for it that long.
  [[nodiscard]] bool IsIdle(std::uint64_t timeout_ns) const;

  /// Between host memory and a buffer; waits.
  void Write(uint binding, const void* data, std::size_t size) const;
  void Read(uint binding, void* data, std::size_t size) const;

  /// Of the last run; empty where passes are not timed.
  [[nodiscard]] std::vector<PassTime> PassTimes() const;
  [[nodiscard]] const Context& context() const { return *context_; }
  /// List entries that one invocation looks at: a processor wants few, long workgroups, a GPU many.
  [[nodiscard]] uint chunk() const { return context_->info.kind == "cpu" ? 256 : 1; }
  [[nodiscard]] uint lanes() const { return context_->info.kind == "cpu" ? 8 : kGroupSize; }

 private:
  struct Pass {
    const char* name;
    vk::raii::Pipeline pipeline;
    std::size_t groups;  ///< offset in Frame of its indirect arguments; kOne: one workgroup
    bool barrier;        ///< false where the next pass does not need this one's results
  };
  static constexpr std::size_t kOne = ~std::size_t{0};

  void MakeBuffers();
  [[nodiscard]] const Buffer& FrameBuffer() const { return copies_in_ ? buffers_[kBindFrame] : frame_in_; }
  void MakePipelines();
  vk::raii::CommandBuffer Record(const std::vector<std::size_t>& passes) const;
  void Copy(const Buffer& from, const Buffer& to, vk::DeviceSize size) const;

  std::unique_ptr<Context> context_;
  ProgramSizes sizes_;
  std::array<Buffer, kBindings> buffers_;
  Buffer frame_in_, own_frame_out_;
  const Buffer* frame_out_{nullptr};
  bool gpu_{false}, copies_in_{false};
  std::vector<vk::raii::BufferView> views_;
  vk::raii::DescriptorSetLayout set_layout_{nullptr};
  vk::raii::PipelineLayout layout_{nullptr};
  vk::raii::DescriptorPool pool_{nullptr};
  vk::raii::DescriptorSets sets_{nullptr};
  vk::raii::CommandPool command_pool_{nullptr};
  std::vector<Pass> passes_;
  std::array<std::vector<std::size_t>, 4> run_passes_;  // by mode
  std::vector<vk::raii::CommandBuffer> commands_;
  FrameMode last_mode_{FrameMode::kLists};
  vk::raii::Fence fence_{nullptr};
  vk::raii::QueryPool stamps_{nullptr};
  double stamp_period_ns_{0.0};  ///< 0: passes are not timed
  bool poll_{false};             ///< ask for the fence instead of waiting: quicker on a GPU
};

}  // namespace osteon::gpu
