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

/// Parameters of SurfaceThread.
struct SurfaceThreadParams {
  /// Room for 8 s at 500 frames/s: the start with a large mesh takes as long, and nothing is carved
  /// meanwhile.
  std::size_t ring_frames{4096};
  std::chrono::milliseconds period{33};  ///< time between two looks into the ring; chunks come no faster
  /// Makes the solid's field. Called on the thread; takes seconds for a mesh.
  std::function<std::shared_ptr<const SolidField>()> make_solid{};
  MaterialAt material{};  ///< empty: 0 everywhere
  /// Carves the bone that was cut before the first frame. Called on the thread; takes seconds. Empty: no bone
  /// was cut before.
  std::function<void(CarvedField&)> carve_earlier{};
  /// Returns whether somebody looks at the surface. Called from any thread. While nobody looks, after the
  /// first mesh, frames are carved but no mesh is made. Empty: somebody always looks.
  std::function<bool()> is_watched{};
  bool keeps_batches{false};  ///< keeps the batches that touch bone, so that TakeBack can leave some out
};

/// Carves and extracts the surface beside the engine, in a thread that the system runs only where a CPU would
/// be idle (SCHED_IDLE). A second thread, of low normal priority, makes the first mesh. It also does the work
/// if the surface has become kMaxAge old because no CPU is ever idle; while that lasts, every kBusyAge
/// (IdleShare).
///
///     engine's thread ──ToolFrame, SpscRing──▶ one of two threads ──chunks──▶ SurfaceSink
///
/// The engine never waits: a full ring refuses a frame, and the next way then starts where the last pushed
/// one ended. The ring's writer is the engine's thread. Its reader is the thread that holds the lock: one of
/// the two threads, or a caller of Apply. SpscRing orders the memory. The idle thread holds the lock for a
/// step of some 0.2 ms of work at a time, and drops its mesh if another thread has carved meanwhile. (There
/// are two threads because a thread needs a privilege to leave SCHED_IDLE.)
class SurfaceThread {
 public:
  /// @param sink  must outlive the thread; called by one thread at a time
  SurfaceThread(const simulation::Tool& tool, const Pose& X_WG, SurfaceThreadParams params,
                SurfaceSink& sink);
  ~SurfaceThread();
  SurfaceThread(const SurfaceThread&) = delete;
  SurfaceThread& operator=(const SurfaceThread&) = delete;

  /// Age of the surface at which the thread of low normal priority makes it.
  static constexpr std::chrono::milliseconds kMaxAge{500};
  /// This age while the idle thread gets no CPU.
  static constexpr std::chrono::milliseconds kBusyAge{200};
  /// Time between two looks of the idle thread into the ring while nobody looks at the surface.
  static constexpr std::chrono::milliseconds kUnwatchedPeriod{200};

  /// Passes a frame on. Engine's thread only.
  /// @returns false where the ring was full
  bool Push(const ToolFrame& frame) OSTEON_RT { return ring_.Push(frame); }

  /// Carves all that was pushed, then lets `change` read or change the field and the ways, and publishes.
  /// Waits for the field, which takes seconds for a mesh. Any thread; also after Stop.
  /// @throws std::runtime_error with error() where the thread has failed; else what `change` throws.
  void Apply(const std::function<void(CarvedField&, ToolWays&)>& change);

  /// Leaves these parts of the way out from now on. The thread soon carves the rest anew; the caller does not
  /// wait. Needs keeps_batches. Any thread.
  /// @param ways  all parts to leave out, including those of earlier calls
  void TakeBack(std::vector<WayTimes> ways);

  /// Carves and publishes what was pushed, and ends the thread. Safe to call twice.
  void Stop();

  /// How far the published surface is behind: it contains all frames that were pushed that long ago, except
  /// those of a batch that is not complete yet (ToolWays::kBatchFrames). Some 40 ms if a CPU is idle now and
  /// then; grows while nobody looks. Any thread.
  [[nodiscard]] std::chrono::nanoseconds age() const;

  /// Frames that the full ring refused; any thread.
  [[nodiscard]] std::size_t skipped_frames() const OSTEON_RT { return ring_.dropped(); }
  /// After Stop: the exception that ended the thread before; empty if there was none.
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  void Run();
  void RunWhenIdle();
  /// Runs Run or RunWhenIdle, and stores the exception that ends it.
  void Guard(void (SurfaceThread::*run)());
  void MakeField();      // makes the solid's field, and publishes the first mesh
  void PassInSteps();    // carves and extracts what is new; lets go of the lock after each step
  void TryForIdleCpu();  // uses CPU time for a moment, so that RunWhenIdle sees whether the thread gets any
  [[nodiscard]] bool IsWatched() const { return !params_.is_watched || params_.is_watched(); }
  [[nodiscard]] bool IsBehind() const;  // whether the surface is too old to wait for an idle CPU
  void CarveAnewIfAsked();              // does the work that TakeBack asked for

  // The functions from here on are called with the lock held.
  bool CarveFrames(std::size_t max_frames);  // returns whether the ring is empty
  void CarveRest();                          // carves the incomplete batch, too
  void CarveFresh();                         // carves the new batches
  void StartPass();  // the field has changed: extracts its dirty bricks from the first on
  // Extracts dirty bricks if somebody looks, and publishes once all are done. Returns whether some are left.
  bool ExtractSome(std::size_t max_bricks);

  SurfaceThreadParams params_;
  SurfaceSink& sink_;
  rt::SpscRing<ToolFrame> ring_;
  std::atomic<bool> stop_{false};
  std::atomic<rt::Nanoseconds> shown_ns_;  // value of read_ns_ for the published surface
  std::atomic<rt::Nanoseconds> read_ns_;   // all frames pushed before this time were read from the ring
  std::atomic<bool> never_idle_{false};    // the idle thread gets no CPU
  // Guards the members from here to error_; the engine's thread locks it only in Apply.
  rt::InheritingMutex mutex_;
  std::condition_variable_any begun_;  // the field is there, or the thread has failed
  std::shared_ptr<const SolidField> solid_;
  std::optional<CarvedField> field_;
  std::optional<TissueBricks> tissue_;
  BatchedWays ways_;
  SweptBatches fresh_;  // not carved yet
  SweptBatches kept_;   // carved; kept if keeps_batches
  std::vector<WayTimes> taken_back_;
  std::vector<SurfaceChunk> chunks_;  // its memory is used again
  bool published_{false};             // the first mesh
  std::size_t extracted_{0};          // dirty bricks that were extracted since the field last changed
  std::uint64_t passes_{0};           // number of changes of the field
  std::string error_;                 // read without the lock once the thread is joined
  std::mutex asked_mutex_;            // guards asked_, and is held briefly
  std::optional<std::vector<WayTimes>> asked_;  // argument of a TakeBack that is not carved yet
  std::thread thread_, idle_thread_;
};

}  // namespace osteon::surface
