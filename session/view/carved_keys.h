#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "session/view/recorded_cut.h"
#include "session/view/recording_timeline.h"
#include "simulation/surface/carved_field.h"
#include "simulation/surface/tool_ways.h"

namespace osteon::session {

/// The carving of a recording's bone, message by message. What the tool swept is gathered and carved at once:
/// many capsules cost little more than a few, since most of them count at no node, and the bits are the same.
struct CarvedBone {
  surface::CarvedField field;
  surface::ToolWays ways;
  bool turns{false};             ///< the spindle, in the last tick
  double at_s{0.0};              ///< of the last tick
  rt::Nanoseconds last_tick{0};  ///< its stamp; 0: none yet

  /// The bone as it was when the recording began.
  CarvedBone(std::shared_ptr<const surface::SolidField> solid, std::shared_ptr<const RecordedCut> cut);

  /// Takes the message that the time line has read. `field` follows with Carve.
  void Take(io::RecordedTopic topic, const RecordingTimeline& timeline);
  /// Carves what was taken, up to the last complete batch of frames.
  void Carve();
  /// Becomes another state of the same recording's bone; only bricks that differ are dirty then.
  void JumpTo(const CarvedBone& other);
  /// Carves what was taken, with the batch that is not complete.
  void CarveAll();

  static constexpr std::size_t kMaxGathered = 4096;  ///< capsules: some ten seconds of a reamer's

 private:
  void Use(std::size_t tool);
  void Gather();

  std::shared_ptr<const RecordedCut> cut_;
  std::size_t tool_{0};  // that `ways` is of
  std::vector<surface::Capsule> gathered_;
};

/// States of the carved bone all along a recording, gathered in the background, so that the bone at any time
/// is one of them and a few seconds of carving.
///
///     0 ──────key──────key──────key─ ─ ─ ─▶ end      at most kMaxKeys, and kMaxBytes; else every second one is
///                        └──carve on──▶ wanted        dropped, and the next ones are twice as far apart
class CarvedKeys {
 public:
  static constexpr std::size_t kMaxKeys = 512;
  static constexpr std::size_t kMaxBytes = std::size_t{256} << 20;
  static constexpr double kFirstStep_s = 5.0;

  /// @param begin  the bone as it was when the recording began
  CarvedKeys(const std::filesystem::path& recording, const CarvedBone& begin);
  ~CarvedKeys();
  CarvedKeys(const CarvedKeys&) = delete;
  CarvedKeys& operator=(const CarvedKeys&) = delete;

  /// The last state at or before a time; null: none yet.
  [[nodiscard]] std::shared_ptr<const CarvedBone> Before(double at_s) const;
  /// Whether the whole recording was read.
  [[nodiscard]] bool complete() const { return complete_.load(); }

 private:
  void Run(const std::filesystem::path& recording, CarvedBone bone);
  void Keep(const CarvedBone& bone);

  double step_s_{kFirstStep_s};  // of the thread
  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<const CarvedBone>> keys_;  // guarded by mutex_, in the order of their times
  std::atomic<bool> stop_{false}, complete_{false};
  std::thread thread_;
};

/// Moves a time line to just after the tick at which a state was kept. False: the tick is not there.
[[nodiscard]] bool GoOnFrom(const CarvedBone& bone, RecordingTimeline& timeline);

}  // namespace osteon::session
