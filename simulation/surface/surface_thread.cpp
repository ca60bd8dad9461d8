#include "simulation/surface/surface_thread.h"

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>

#include "base/realtime_thread.h"

namespace osteon::surface {
namespace {

// A step of the idle thread: some 0.2 ms of work.
constexpr std::size_t kFramesAStep = 4 * ToolWays::kBatchFrames, kBricksAStep = 16;
constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

/// Lets the system run the calling thread only on a CPU that nobody else wants. With an ordinary priority,
/// however low, the engine's frames take 2 ms longer (95th percentile, 2 cores).
void WaitForIdleCpus() {
  const sched_param none{};
  (void)pthread_setschedparam(pthread_self(), SCHED_IDLE, &none);
}

}  // namespace

SurfaceThread::SurfaceThread(const simulation::Tool& tool, const Pose& X_WG, SurfaceThreadParams params,
                             SurfaceSink& sink)
    : params_(std::move(params)),
      sink_(sink),
      ring_(params_.ring_frames),
      shown_ns_(rt::MonotonicNow()),
      ways_(tool, X_WG),
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

void SurfaceThread::Apply(const std::function<void(CarvedField&, ToolWays&)>& change) {
  std::unique_lock lock(mutex_);
  begun_.wait(lock, [this] { return field_ || !error_.empty(); });
  if (!error_.empty()) throw std::runtime_error(error_);
  CarveFrames(kAll);
  CarveRest();
  change(*field_, ways_);
  StartPass();
  ExtractSome(kAll);
}

void SurfaceThread::Run() {
  rt::NameThread("surface");
  rt::LowerPriority();
  MakeField();
  while (!stop_.load()) {
    std::this_thread::sleep_for(params_.period);
    if (age() < kMaxAge) continue;
    const std::lock_guard lock(mutex_);
    CarveFrames(kAll);
    ExtractSome(kAll);
  }
  const std::lock_guard lock(mutex_);
  if (!error_.empty()) return;
  CarveFrames(kAll);
  CarveRest();
  ExtractSome(kAll);
}

void SurfaceThread::RunWhenIdle() {
  rt::NameThread("surface, idle");
  WaitForIdleCpus();
  for (auto next = std::chrono::steady_clock::now(); !stop_.load();) {
    PassInSteps();
    next = std::max(next + params_.period, std::chrono::steady_clock::now() + params_.period / 4);
    std::this_thread::sleep_until(next);
  }
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
  CarvedField field(params_.make_solid());
  const std::lock_guard lock(mutex_);
  sink_.Begin(field.layout());
  tissue_.emplace(field.layout(), params_.material);
  field_ = std::move(field);
  begun_.notify_all();
  CarveFrames(kAll);
  ExtractSome(kAll);
}

void SurfaceThread::PassInSteps() {
  std::uint64_t pass = 0;
  for (bool emptied = false; !emptied;) {
    const std::lock_guard lock(mutex_);
    if (!field_) return;
    emptied = CarveFrames(kFramesAStep);
    pass = passes_;
  }
  for (bool more = true; more && !stop_.load();) {
    const std::lock_guard lock(mutex_);
    more = pass == passes_ && ExtractSome(kBricksAStep);
  }
}

bool SurfaceThread::CarveFrames(std::size_t max_frames) {
  const rt::Nanoseconds now = rt::MonotonicNow();
  capsules_.clear();
  std::size_t count = 0;
  for (ToolFrame frame; count < max_frames && ring_.Pop(frame); ++count)
    if (ways_.Add(frame)) {
      const std::vector<Capsule> swept = ways_.TakeCapsules();
      capsules_.insert(capsules_.end(), swept.begin(), swept.end());
    }
  // at once: most of a batch's capsules count at no node beside a later batch's
  if (!capsules_.empty()) Carve(capsules_);
  const bool emptied = count < max_frames;
  if (emptied) read_ns_ = now;
  return emptied;
}

void SurfaceThread::CarveRest() { Carve(ways_.TakeCapsules()); }

void SurfaceThread::Carve(const std::vector<Capsule>& capsules) {
  field_->Carve(capsules);
  StartPass();
}

void SurfaceThread::StartPass() {
  ++passes_;
  extracted_ = 0;
}

bool SurfaceThread::ExtractSome(std::size_t max_bricks) {
  const auto dirty = field_->Dirty();
  if (chunks_.size() < dirty.size()) chunks_.resize(dirty.size());
  for (; max_bricks > 0 && extracted_ < dirty.size(); --max_bricks, ++extracted_)
    ExtractChunk(*field_, dirty[extracted_], chunks_[extracted_], {}, tissue_->OfBrick(dirty[extracted_]));
  if (extracted_ < dirty.size()) return true;
  if (!dirty.empty()) sink_.Publish(std::span(chunks_).first(dirty.size()), ways_.frame());
  field_->ClearDirty();
  extracted_ = 0;
  shown_ns_.store(read_ns_);
  return false;
}

}  // namespace osteon::surface
