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
  /// Number of frames in the ring: 8 s at 500 frames/s. The start with a large mesh takes as long, and
  /// nothing is carved meanwhile.
  std::size_t ring_frames{4096};
  /// Time between two polls of the ring; chunks are published no faster
  std::chrono::milliseconds period{33};
  /// Makes the solid's field. Called on the thread; takes seconds for a mesh.
  std::function<std::shared_ptr<const SolidField>()> make_solid{};
  MaterialAt material{};  ///< empty: 0 everywhere
  /// Carves the bone that was cut before the first frame. Called on the thread; takes seconds. Empty: no bone
  /// was cut before.
  std::function<void(CarvedField&)> carve_earlier{};
  /// Returns whether somebody watches the surface. Called from any thread. After the first mesh, frames are
  /// still carved while nobody watches, but no mesh is made. Empty: the surface is always watched.
  std::function<bool()> is_watched{};
  /// true: stores the batches that touch bone, so that Undo can leave some out
  bool keeps_batches{false};
};

/// Carves and extracts the surface beside the engine, in a thread that the system runs only where a CPU would
/// be idle (SCHED_IDLE). A second thread, of low normal priority, makes the first mesh. If no CPU is ever
/// idle and the surface is older than kMaxAge, the second thread does the work. As long as no CPU is idle
/// (IdleShare), it works whenever the surface is older than kBusyAge.
///
///     engine's thread ──ToolFrame, SpscRing──▶ one of two threads ──chunks──▶ SurfaceSink
///
/// The engine never waits: a full ring refuses a frame, and the next path then starts where that of the last
/// pushed frame ended. The ring's writer is the engine's thread. Its reader is the thread that holds the
/// lock: one of the two threads, or a caller of Apply. SpscRing provides the memory ordering. The idle thread
/// holds the lock for a step of some 0.2 ms of work at a time, and drops its mesh if another thread has
/// carved meanwhile. (There are two threads because a thread needs a privilege to leave SCHED_IDLE.)
class SurfaceThread {
 public:
  /// @param sink  must outlive the thread; called by one thread at a time
  SurfaceThread(const simulation::Tool& tool, const Pose& X_WG, SurfaceThreadParams params,
                SurfaceSink& sink);
  ~SurfaceThread();
  SurfaceThread(const SurfaceThread&) = delete;
  SurfaceThread& operator=(const SurfaceThread&) = delete;

  /// Age of the surface at which the thread of low normal priority updates it.
  static constexpr std::chrono::milliseconds kMaxAge{500};
  /// The same age while the idle thread gets no CPU.
  static constexpr std::chrono::milliseconds kBusyAge{200};
  /// Time between two polls of the ring by the idle thread while nobody watches the surface.
  static constexpr std::chrono::milliseconds kUnwatchedPeriod{200};

  /// Pushes a frame into the ring. Called only by the engine's thread.
  /// @returns false if the ring was full
  bool Push(const ToolFrame& frame) OSTEON_RT { return ring_.Push(frame); }

  /// Carves all pushed frames, lets `change` read or change the field and the tool's path, and publishes.
  /// First waits until the field is made, which takes seconds for a mesh. Any thread may call it, also after
  /// Stop.
  /// @throws std::runtime_error with error() if the thread has failed; otherwise what `change` throws.
  void Apply(const std::function<void(CarvedField&, ToolSweep&)>& change);

  /// Undoes these parts of the tool's path: the thread soon carves the rest of the path anew, and the caller
  /// does not wait. Needs keeps_batches. Any thread may call it.
  /// @param parts  all parts to undo, including those of earlier calls
  void Undo(std::vector<SweepTimes> parts);

  /// Carves and publishes all pushed frames, and ends the threads. May be called twice.
  void Stop();

  /// Age of the published surface: the surface contains all frames that were pushed at least this long ago,
  /// except those of a batch that is not complete yet (ToolSweep::kBatchFrames). It is some 40 ms if a CPU is
  /// idle now and then, and grows while nobody watches. Any thread may call it.
  [[nodiscard]] std::chrono::nanoseconds age() const;

  /// Number of frames that the full ring refused. Any thread may call it.
  [[nodiscard]] std::size_t skipped_frames() const OSTEON_RT { return ring_.dropped(); }
  /// After Stop: the exception that ended the thread before; empty if there was none.
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  void Run();
  void RunWhenIdle();
  /// Runs Run or RunWhenIdle, and stores the exception that ends it.
  void Guard(void (SurfaceThread::*run)());
  void MakeField();      // makes the solid's field, and publishes the first mesh
  void PassInSteps();    // carves and extracts what is new; releases the lock after each step
  void TryForIdleCpu();  // uses CPU time for a moment, so that RunWhenIdle sees whether the thread gets any
  [[nodiscard]] bool IsWatched() const { return !params_.is_watched || params_.is_watched(); }
  [[nodiscard]] bool IsBehind() const;  // whether the surface is too old to wait for an idle CPU
  void CarveAnewIfAsked();              // carves the field anew if Undo has asked for it

  // The functions from here on are called with the lock held.
  bool CarveFrames(std::size_t max_frames);  // returns whether the ring is empty
  void CarveRest();                          // carves all frames, also those of the incomplete batch
  void CarveFresh();                         // carves the new batches
  void StartPass();  // the field has changed: extracts its dirty bricks from the first on
  // Extracts dirty bricks if somebody watches, and publishes when all are extracted. Returns whether some are
  // left.
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
  BatchedSweep sweep_;
  SweptBatches fresh_;  // batches that are not carved yet
  SweptBatches kept_;   // carved batches; stored only if keeps_batches
  std::vector<SweepTimes> undone_;
  std::vector<SurfaceChunk> chunks_;  // kept, so that its memory is reused
  bool published_{false};             // the first mesh was published
  std::size_t extracted_{0};          // dirty bricks that were extracted since the field last changed
  std::uint64_t passes_{0};           // number of changes of the field
  std::string error_;                 // read without the lock once the thread is joined
  std::mutex asked_mutex_;            // guards asked_, and is held briefly
  std::optional<std::vector<SweepTimes>> asked_;  // argument of an Undo that is not carved yet
  std::thread thread_, idle_thread_;
};

}  // namespace osteon::surface
