#include "session/view/view_surface.h"

#include <chrono>
#include <span>
#include <utility>

#include "base/realtime_thread.h"
#include "simulation/surface/bone_solid.h"
#include "simulation/surface/dual_surface.h"

namespace osteon::app {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPeriod{40};  // between looks at the wanted time
constexpr std::chrono::milliseconds kSlice{250};  // of carving before the bone is shown
constexpr int kMessagesPerLook = 500;             // at the clock

}  // namespace

ViewSurface::ViewSurface(const std::filesystem::path& recording, const CellSetup& setup,
                         surface::SurfaceSink& sink)
    : recording_(recording), setup_(setup), sink_(sink), thread_([this] { Run(); }) {}

ViewSurface::~ViewSurface() {
  stop_.store(true);
  thread_.join();
}

void ViewSurface::Run() {
  rt::NameThread("view surface");
  rt::LowerPriority();
  if (!setup_.solid && setup_.bone.balls.empty()) return;
  try {
    const float voxel_mm = surface::VoxelFor(setup_.config.tool.tool);
    solid_ = surface::FieldOfBone(setup_.solid.get(), setup_.bone, voxel_mm);
    Begin(CarvedBone(solid_, setup_));
    keys_ = std::make_unique<CarvedKeys>(recording_, setup_, solid_);
    while (!stop_.load()) {
      const double wanted_s = wanted_s_.load();
      keys_complete_.store(keys_->complete());
      GoNear(wanted_s);
      const bool more = !ended_ && wanted_s > bone_->at_s && CarveOn(wanted_s);
      Publish();
      if (!more) std::this_thread::sleep_for(kPeriod);
    }
  } catch (const std::exception&) {  // a grid that no memory holds: the page stays without the bone
  }
}

void ViewSurface::Begin(const CarvedBone& from) {
  if (!timeline_)
    if (auto timeline = RecordingTimeline::Open(recording_))
      timeline_ = std::make_unique<RecordingTimeline>(std::move(*timeline));
  ended_ = !timeline_ || !GoOnFrom(from, *timeline_);
  bone_.emplace(from);
  sink_.Begin(bone_->field.layout());
}

// Goes back, or on to a key state that is much nearer to a time than what is shown.
void ViewSurface::GoNear(double wanted_s) {
  const bool back = wanted_s < bone_->at_s;
  const std::shared_ptr<const CarvedBone> key = keys_->Before(wanted_s);
  if (key && (back || key->at_s > bone_->at_s + CarvedKeys::kFirstStep_s))
    Begin(*key);
  else if (back)
    Begin(CarvedBone(solid_, setup_));
}

// Carves up to a time, or for kSlice. True if it has not got there.
bool ViewSurface::CarveOn(double wanted_s) {
  const auto until = Clock::now() + kSlice;
  for (int messages = 1; bone_->at_s < wanted_s && !stop_.load(); ++messages) {
    const auto topic = timeline_->Next();
    if (!topic || *topic == io::RecordedTopic::kOther) {
      ended_ = true;
      break;
    }
    bone_->Take(*topic, *timeline_);
    if (messages % kMessagesPerLook == 0 && Clock::now() > until) return true;
  }
  return false;
}

void ViewSurface::Publish() {
  if (ended_ || bone_->at_s >= wanted_s_.load()) bone_->field.Carve(bone_->ways.TakeCapsules());
  const auto dirty = bone_->field.Dirty();
  if (!dirty.empty()) {
    if (chunks_.size() < dirty.size()) chunks_.resize(dirty.size());
    const auto material = [this](surface::Vec3 p_mm) {
      return setup_.solid ? setup_.solid->MaterialAt(1e-3 * Vector3(p_mm.x, p_mm.y, p_mm.z))
                          : std::uint8_t{0};
    };
    for (std::size_t i = 0; i < dirty.size(); ++i)
      surface::ExtractChunk(bone_->field, dirty[i], chunks_[i], {}, material);
    sink_.Publish(std::span(chunks_).first(dirty.size()), bone_->ways.frame());
    bone_->field.ClearDirty();
  }
  shown_s_.store(bone_->at_s);
}

}  // namespace osteon::app
