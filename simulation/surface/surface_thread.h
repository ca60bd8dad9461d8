#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/clock.h"
#include "base/inheriting_mutex.h"
#include "base/spsc_ring.h"
#include "simulation/surface/carved_field.h"
#include "simulation/surface/dual_surface.h"
#include "simulation/surface/surface_sink.h"
#include "simulation/surface/swept_batches.h"
#include "simulation/surface/tissue_bricks.h"

namespace osteon::surface {

struct SurfaceThreadParams {
  std::size_t ring_frames{4096};         ///< 8 s at 500 frames/s: a start with a large mesh is behind so long
  std::chrono::milliseconds period{33};  ///< from one look into the ring to the next; chunks come no faster
  /// Makes the solid's field, on the thread (seconds, for a mesh).
  std::function<std::shared_ptr<const SolidField>()> make_solid{};
  MaterialAt material{};  ///< empty: 0 everywhere
  /// Carves what was cut before the first frame, on the thread (seconds). Empty: nothing was.
  std::function<void(CarvedField&)> carve_earlier{};
  /// Whether somebody looks; any thread. While nobody does, only the field follows, after the first mesh.
  /// Empty: always.
  std::function<bool()> is_watched{};
  bool keeps_batches{false};  ///< what touches bone is kept, so that TakeBack can leave a part of it out
};

/// Carves and extracts the surface beside the engine, in a thread that the system runs only where a CPU would
/// be idle (SCHED_IDLE). A second one of low normal priority makes the first mesh, and does the work wherever
/// the surface is kMaxAge old because no CPU is ever idle; where that lasts, every kBusyAge (IdleShare).
///
///     engine's thread ──ToolFrame, SpscRing──▶ one of two threads ──chunks──▶ SurfaceSink
///
/// The engine never waits: a full ring refuses a frame, and the next way then starts where the last pushed
/// one ended. Writer of the ring is the engine's thread; its reader is who holds the lock: one of the two
/// threads, or who calls Apply; memory order by SpscRing. The idle one holds the lock for a step of some 0.2
/// ms of work at a time, and gives its work up where another one has taken the lock meanwhile. (Two threads,
/// since the system lets none leave SCHED_IDLE without a privilege.)
class SurfaceThread {
 public:
  /// @param sink  must outlive the thread; called by one thread at a time
  SurfaceThread(const simulation::Tool& tool, const Pose& X_WG, SurfaceThreadParams params,
                SurfaceSink& sink);
  ~SurfaceThread();
  SurfaceThread(const SurfaceThread&) = delete;
  SurfaceThread& operator=(const SurfaceThread&) = delete;

  /// Age at which the surface is made at a low normal priority.
  static constexpr std::chrono::milliseconds kMaxAge{500};
  /// The same while the idle thread gets no CPU.
  static constexpr std::chrono::milliseconds kBusyAge{200};
  /// From one look into the ring to the next while nobody looks.
  static constexpr std::chrono::milliseconds kUnwatchedPeriod{200};

  /// Passes a frame on. Engine's thread only.
  /// @returns false where the ring was full
  bool Push(const ToolFrame& frame) OSTEON_RT { return ring_.Push(frame); }

  /// Carves all that was pushed, then lets `change` read or change the field and the ways, and publishes.
  /// Waits for the field, which takes seconds for a mesh. Any thread; also after Stop.
  /// @throws std::runtime_error with error() where the thread has failed; else what `change` throws.
  void Apply(const std::function<void(CarvedField&, ToolWays&)>& change);

  /// Leaves these parts of the way out from now on, and carves the rest anew: soon, on the thread; nobody
  /// waits. Only with keeps_batches. Any thread.
  /// @param ways  all of them, with those of earlier calls
  void TakeBack(std::vector<WayTimes> ways);

  /// Carves and publishes what was pushed, and ends the thread. Safe to call twice.
  void Stop();

  /// How far the published surface is behind: all frames that were pushed that long ago are in it. Some 40 ms
  /// where a CPU is idle now and then; grows while nobody looks. Any thread.
  [[nodiscard]] std::chrono::nanoseconds age() const;

  /// Frames that the full ring refused; any thread.
  [[nodiscard]] std::size_t skipped_frames() const OSTEON_RT { return ring_.dropped(); }
  /// After Stop: the exception that ended the thread before; empty if there was none.
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  void Run();
  void RunWhenIdle();
  /// Runs one of both, and notes the exception that ends it.
  void Guard(void (SurfaceThread::*run)());
  void MakeField();
  void PassInSteps();
  void TryForIdleCpu();
  [[nodiscard]] bool IsWatched() const { return !params_.is_watched || params_.is_watched(); }
  [[nodiscard]] bool IsBehind() const;  // so far that it can't wait for an idle CPU
  void CarveAnewIfAsked();

  // with the lock, as what follows
  bool CarveFrames(std::size_t max_frames);  // returns whether the ring is empty
  void CarveRest();                          // of a batch that is not complete
  void CarveFresh();                         // the batches that are new
  void StartPass();
  // Where somebody looks: publishes once all are there; returns whether some are left.
  bool ExtractSome(std::size_t max_bricks);

  SurfaceThreadParams params_;
  SurfaceSink& sink_;
  rt::SpscRing<ToolFrame> ring_;
  std::atomic<bool> stop_{false};
  std::atomic<rt::Nanoseconds> shown_ns_;  // frames pushed before are published
  std::atomic<rt::Nanoseconds> read_ns_;   // frames pushed before are carved
  std::atomic<bool> never_idle_{false};    // the idle thread gets no CPU
  rt::InheritingMutex mutex_;              // of what follows; the engine's thread takes it in Apply alone
  std::condition_variable_any begun_;      // the field is there, or the thread has failed
  std::shared_ptr<const SolidField> solid_;
  std::optional<CarvedField> field_;
  std::optional<TissueBricks> tissue_;
  BatchedWays ways_;
  SweptBatches fresh_, kept_;
  std::vector<WayTimes> taken_back_;
  std::vector<SurfaceChunk> chunks_;  // its memory is used again
  bool published_{false};             // the first mesh
  std::size_t extracted_{0};          // of the field's dirty bricks, since the field last changed
  std::uint64_t passes_{0};           // grows as the field changes
  std::string error_;                 // read without the lock once the thread is joined
  std::mutex asked_mutex_;            // of what follows, and held briefly
  std::optional<std::vector<WayTimes>> asked_;
  std::thread thread_, idle_thread_;
};

}  // namespace osteon::surface
