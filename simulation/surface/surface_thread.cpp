#include "simulation/surface/surface_thread.h"

#include <pthread.h>
#include <sched.h>
#include <time.h>

#include <algorithm>
#include <exception>
#include <iterator>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>

#include "base/realtime_thread.h"
#include "simulation/surface/idle_share.h"

namespace osteon::surface {
namespace {

// Largest numbers of frames and of bricks in one step of the idle thread: some 0.2 ms of work.
constexpr std::size_t kFramesPerStep = 4 * ToolSweep::kBatchFrames, kBricksPerStep = 16;
// Number of chunks whose memory is kept for the next change. The first mesh has all bricks of the bone, a
// later change some dozens.
constexpr std::size_t kKeptChunks = 256;
// A limit for one step that allows all frames, or all bricks.
constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

/// Makes the system run the calling thread only on a CPU that no other thread wants (SCHED_IDLE). With an
/// ordinary priority, however low, the engine's frames take 2 ms longer (95th percentile, 2 cores).
void UseOnlyIdleCpus() {
  const sched_param none{};
  (void)pthread_setschedparam(pthread_self(), SCHED_IDLE, &none);
}

// CPU time of the calling thread.
rt::Nanoseconds CpuTime() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return time.tv_sec * rt::kSecond + time.tv_nsec;
}

}  // namespace

SurfaceThread::SurfaceThread(const simulation::Tool& tool, const Pose& X_WG, SurfaceThreadParams params,
                             SurfaceSink& sink)
    : params_(std::move(params)),
      sink_(sink),
      ring_(params_.ring_frames),
      shown_ns_(rt::MonotonicNow()),
      read_ns_(shown_ns_.load()),
      sweep_(tool, X_WG),
      thread_([this] { Guard(&SurfaceThread::Run); }),
      idle_thread_([this] { Guard(&SurfaceThread::RunWhenIdle); }) {}

SurfaceThread::~SurfaceThread() { Stop(); }

void SurfaceThread::Stop() {
  stop_.store(true);
  if (idle_thread_.joinable()) idle_thread_.join();
  if (thread_.joinable()) thread_.join();
}

std::chrono::nanoseconds SurfaceThread::age() const {
  return std::chrono::nanoseconds(rt::MonotonicNow() - shown_ns_.load());
}

void SurfaceThread::Apply(const std::function<void(CarvedField&, ToolSweep&)>& change) {
  std::unique_lock lock(mutex_);
  begun_.wait(lock, [this] { return field_ || !error_.empty(); });
  if (!error_.empty()) throw std::runtime_error(error_);
  CarveFrames(kAll);
  CarveRest();
  change(*field_, sweep_.sweep());
  StartPass();
  ExtractSome(kAll);
}

void SurfaceThread::Undo(std::vector<SweepTimes> parts) {
  const std::lock_guard lock(asked_mutex_);
  asked_ = std::move(parts);
}

// Carves a second field while the published one stays in use, so that no thread waits for the lock meanwhile.
// Then takes the lock, adds the batches that have arrived since, and replaces the published field.
void SurfaceThread::CarveAnewIfAsked() {
  std::optional<std::vector<SweepTimes>> asked;
  {
    const std::lock_guard lock(asked_mutex_);
    asked = std::exchange(asked_, std::nullopt);
  }
  if (!asked) return;
  SweptBatches batches;
  {
    const std::lock_guard lock(mutex_);
    CarveFrames(kAll);
    undone_ = *asked;
    batches = kept_;
  }
  CarvedField new_field(solid_);
  if (params_.carve_earlier) params_.carve_earlier(new_field);
  new_field.Carve(CapsulesOf(batches, *asked));
  const std::lock_guard lock(mutex_);
  CarveFrames(kAll);
  new_field.Carve(
      CapsulesOf({kept_.begin() + static_cast<std::ptrdiff_t>(batches.size()), kept_.end()}, *asked));
  field_->SetSwept(new_field.swept());
  StartPass();
  ExtractSome(kAll);
}

void SurfaceThread::Run() {
  rt::NameThread("surface");
  rt::LowerPriority();
  MakeField();
  while (!stop_.load()) {
    std::this_thread::sleep_for(params_.period);
    CarveAnewIfAsked();
    if (!IsBehind()) continue;
    const std::lock_guard lock(mutex_);
    CarveFrames(kAll);
    ExtractSome(kAll);
  }
  {
    const std::lock_guard lock(mutex_);
    if (!error_.empty()) return;
  }
  CarveAnewIfAsked();
  const std::lock_guard lock(mutex_);
  CarveFrames(kAll);
  CarveRest();
  ExtractSome(kAll);
}

bool SurfaceThread::IsBehind() const {
  const rt::Nanoseconds since = IsWatched() ? shown_ns_.load() : read_ns_.load();
  return std::chrono::nanoseconds(rt::MonotonicNow() - since) >= (never_idle_.load() ? kBusyAge : kMaxAge);
}

void SurfaceThread::RunWhenIdle() {
  rt::NameThread("surface, idle");
  UseOnlyIdleCpus();
  IdleShare share;
  for (auto next = std::chrono::steady_clock::now(); !stop_.load();) {
    const rt::Nanoseconds began = rt::MonotonicNow(), began_cpu = CpuTime();
    const IdleShare::Next turn = share.At(began);
    if (turn == IdleShare::Next::kTry) TryForIdleCpu();
    if (turn == IdleShare::Next::kWork) PassInSteps();
    if (turn != IdleShare::Next::kRest) {
      const rt::Nanoseconds now = rt::MonotonicNow();
      share.Ended(now, now - began, CpuTime() - began_cpu);
      never_idle_.store(share.At(now) != IdleShare::Next::kWork);
    }
    const auto period = IsWatched() ? params_.period : std::max(params_.period, kUnwatchedPeriod);
    // A late pass moves the next one, so that at least a quarter of the period is left to other work.
    next = std::max(next + period, std::chrono::steady_clock::now() + params_.period / 4);
    std::this_thread::sleep_until(next);
  }
}

// Uses CPU time without the lock. RunWhenIdle measures from it whether the thread gets a CPU.
void SurfaceThread::TryForIdleCpu() {
  const rt::Nanoseconds end = CpuTime() + IdleShare::kTryTime;
  while (CpuTime() < end && !stop_.load()) continue;
}

void SurfaceThread::Guard(void (SurfaceThread::*run)()) {
  try {
    (this->*run)();
  } catch (const std::exception& error) {
    stop_.store(true);
    const std::lock_guard lock(mutex_);
    if (error_.empty()) error_ = error.what();
    begun_.notify_all();
  }
}

void SurfaceThread::MakeField() {
  auto solid = params_.make_solid();
  CarvedField field(solid);
  if (params_.carve_earlier) params_.carve_earlier(field);
  const std::lock_guard lock(mutex_);
  sink_.Begin(field.layout());
  tissue_.emplace(field.layout(), params_.material);
  solid_ = std::move(solid);
  field_ = std::move(field);
  begun_.notify_all();
  CarveFrames(kAll);
  ExtractSome(kAll);
}

void SurfaceThread::PassInSteps() {
  // Carve all pushed frames. Then extract until the mesh is complete, or another thread has changed the
  // field.
  std::uint64_t pass = 0;
  for (bool emptied = false; !emptied;) {
    const std::lock_guard lock(mutex_);
    if (!field_) return;
    emptied = CarveFrames(kFramesPerStep);
    pass = passes_;
  }
  for (bool more = true; more && !stop_.load() && !IsBehind();) {
    const std::lock_guard lock(mutex_);
    more = pass == passes_ && ExtractSome(kBricksPerStep);
  }
}

bool SurfaceThread::CarveFrames(std::size_t max_frames) {
  const rt::Nanoseconds now = rt::MonotonicNow();
  std::size_t count = 0;
  for (ToolFrame frame; count < max_frames && ring_.Pop(frame); ++count) sweep_.Add(frame, fresh_);
  // Carve all new batches in one call. Most nodes get their value from the last batch, so separate calls
  // would do most of the work in vain.
  if (!fresh_.empty()) CarveFresh();
  const bool emptied = count < max_frames;
  if (emptied) read_ns_.store(now);
  return emptied;
}

void SurfaceThread::CarveRest() {
  sweep_.EndBatch(fresh_);
  CarveFresh();
}

void SurfaceThread::CarveFresh() {
  field_->Carve(CapsulesOf(fresh_, undone_));
  if (params_.keeps_batches)
    std::ranges::copy_if(fresh_, std::back_inserter(kept_), [](const auto& batch) { return batch->touches; });
  fresh_.clear();
  StartPass();
}

void SurfaceThread::StartPass() {
  ++passes_;
  extracted_ = 0;
}

bool SurfaceThread::ExtractSome(std::size_t max_bricks) {
  if (published_ && !IsWatched()) return false;
  const auto dirty = field_->Dirty();
  if (chunks_.size() < dirty.size()) chunks_.resize(dirty.size());
  for (; max_bricks > 0 && extracted_ < dirty.size(); --max_bricks, ++extracted_)
    ExtractChunk(*field_, dirty[extracted_], chunks_[extracted_], {}, tissue_->OfBrick(dirty[extracted_]));
  if (extracted_ < dirty.size()) return true;
  if (!dirty.empty()) sink_.Publish(std::span(chunks_).first(dirty.size()), sweep_.frame());
  field_->ClearDirty();
  chunks_.resize(std::min(chunks_.size(), kKeptChunks));
  published_ = true;
  extracted_ = 0;
  shown_ns_.store(read_ns_.load());
  return false;
}

}  // namespace osteon::surface
