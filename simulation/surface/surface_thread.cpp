#include "simulation/surface/surface_thread.h"

#include <pthread.h>
#include <sched.h>

#include <exception>
#include <stdexcept>
#include <utility>

#include "base/realtime_thread.h"

namespace osteon::surface {
namespace {

/// Lets the system run the calling thread only on a CPU that nobody else wants. With an ordinary priority,
/// however low, the engine's frames take 2 ms longer (95th percentile, 2 cores).
void RunWhenIdle() {
  const sched_param none{};
  (void)pthread_setschedparam(pthread_self(), SCHED_IDLE, &none);
}

}  // namespace

SurfaceThread::SurfaceThread(const simulation::Tool& tool, const Pose& X_WG, SurfaceThreadParams params,
                             SurfaceSink& sink)
    : params_(std::move(params)), sink_(sink), ring_(params_.ring_frames), ways_(tool, X_WG), thread_([this] {
        try {
          Loop();
        } catch (const std::exception& error) {
          const std::lock_guard lock(mutex_);
          error_ = error.what();
          begun_.notify_all();
        }
      }) {}

SurfaceThread::~SurfaceThread() { Stop(); }

void SurfaceThread::Stop() {
  stop_.store(true);
  if (thread_.joinable()) thread_.join();
}

void SurfaceThread::Apply(const std::function<void(CarvedField&, ToolWays&)>& change) {
  std::unique_lock lock(mutex_);
  begun_.wait(lock, [this] { return field_ || !error_.empty(); });
  if (!error_.empty()) throw std::runtime_error(error_);
  CarveFrames();
  field_->Carve(ways_.TakeCapsules());
  change(*field_, ways_);
  PublishDirty();
}

void SurfaceThread::Loop() {
  rt::NameThread("surface");
  RunWhenIdle();
  {
    CarvedField field(params_.make_solid());
    const std::lock_guard lock(mutex_);
    sink_.Begin(field.layout());
    tissue_.emplace(field.layout(), params_.material);
    field_ = std::move(field);
    begun_.notify_all();
  }
  for (bool stopping = false; !stopping;) {
    stopping = stop_.load();  // before the ring is read: what was pushed until Stop is carved
    {
      const std::lock_guard lock(mutex_);
      CarveFrames();
      if (stopping) field_->Carve(ways_.TakeCapsules());
      PublishDirty();
    }
    if (!stopping) std::this_thread::sleep_for(params_.period);
  }
}

void SurfaceThread::CarveFrames() {
  capsules_.clear();
  for (ToolFrame frame; ring_.Pop(frame);)
    if (ways_.Add(frame)) {
      const std::vector<Capsule> swept = ways_.TakeCapsules();
      capsules_.insert(capsules_.end(), swept.begin(), swept.end());
    }
  field_->Carve(capsules_);  // at once: most of a batch's capsules count at no node beside a later batch's
}

void SurfaceThread::PublishDirty() {
  const auto dirty = field_->Dirty();
  if (dirty.empty()) return;
  if (chunks_.size() < dirty.size()) chunks_.resize(dirty.size());
  for (std::size_t i = 0; i < dirty.size(); ++i)
    ExtractChunk(*field_, dirty[i], chunks_[i], {}, tissue_->OfBrick(dirty[i]));
  sink_.Publish(std::span(chunks_).first(dirty.size()), ways_.frame());
  field_->ClearDirty();
}

}  // namespace osteon::surface
