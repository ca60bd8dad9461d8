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
#include "simulation/surface/tool_sweep.h"

namespace osteon::session {

/// The state of a recording's bone at a time. Carving continues from it, message by message. The capsules
/// that the tool has swept are gathered and carved together. This is cheap, because most capsules change no
/// node of the field's grid. The field is bit for bit the same as if each capsule were carved alone.
struct CarvedBone {
  surface::CarvedField field;
  surface::ToolSweep sweep;      ///< path of the tool in use, from which the swept capsules are made
  bool turns{false};             ///< whether the spindle turned in the last tick
  double at_s{0.0};              ///< time of the last tick on the time line
  rt::Nanoseconds last_tick{0};  ///< stamp of the last tick; 0: there was none yet

  /// Makes the bone as it was when the recording began.
  CarvedBone(std::shared_ptr<const surface::SolidField> solid, std::shared_ptr<const RecordedCut> cut);

  /// Takes the message that the time line has read. Carve applies it to `field`.
  void Take(io::RecordedTopic topic, const RecordingTimeline& timeline);
  /// Carves the messages taken so far, up to the last complete batch: ToolSweep makes capsules from a batch
  /// of several frames at once. The frames of an incomplete batch wait.
  void Carve();
  /// Becomes a copy of another state of the same recording's bone. Only the bricks (blocks of the field's
  /// grid) that differ are marked as changed, so that the surface is made anew there alone.
  void JumpTo(const CarvedBone& other);
  /// Carves the messages taken so far, including the batch that is not complete: the exact state at a time.
  void CarveAll();

  static constexpr std::size_t kMaxGathered = 4096;  ///< most gathered capsules: some ten seconds of reaming

 private:
  void Use(std::size_t tool);  // sets the tool for the following path
  void Gather();               // moves the swept capsules from `sweep` to gathered_

  std::shared_ptr<const RecordedCut> cut_;
  std::size_t tool_{0};                     // the tool whose path is in `sweep`
  std::vector<surface::Capsule> gathered_;  // swept, but not carved yet
};

/// States of the carved bone at times all along a recording, made in the background. The bone at any time is
/// then found by carving a few seconds on from the last state before that time.
///
///     0 ──────key──────key──────key─ ─ ─ ─▶ end      at most kMaxKeys, and kMaxBytes; else every second one is
///                        └──carve on──▶ wanted        dropped, and the next ones are twice as far apart
class CarvedKeys {
 public:
  static constexpr std::size_t kMaxKeys = 512;                      ///< number of states
  static constexpr std::size_t kMaxBytes = std::size_t{256} << 20;  ///< memory of all states: 256 MiB
  static constexpr double kFirstStep_s = 5.0;                       ///< initial time between states

  /// @param begin  the bone as it was when the recording began
  CarvedKeys(const std::filesystem::path& recording, const CarvedBone& begin);
  ~CarvedKeys();
  CarvedKeys(const CarvedKeys&) = delete;
  CarvedKeys& operator=(const CarvedKeys&) = delete;

  /// Returns the last state at or before a time; null: there is none yet.
  [[nodiscard]] std::shared_ptr<const CarvedBone> Before(double at_s) const;
  /// Whether the whole recording was read.
  [[nodiscard]] bool complete() const { return complete_.load(); }

 private:
  void Run(const std::filesystem::path& recording, CarvedBone bone);
  // Keeps a state; if there are too many or too large ones, drops every second one and doubles step_s_.
  void Keep(const CarvedBone& bone);

  double step_s_{kFirstStep_s};  // time between states; used only by the thread
  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<const CarvedBone>> keys_;  // guarded by mutex_, in the order of their times
  std::atomic<bool> stop_{false}, complete_{false};
  std::thread thread_;
};

/// Moves a time line to just after the tick at which a state was kept.
/// @returns false if the recording does not have this tick
[[nodiscard]] bool GoOnFrom(const CarvedBone& bone, RecordingTimeline& timeline);

}  // namespace osteon::session
