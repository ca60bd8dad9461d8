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
    solid_ = setup_.solid ? surface::SampleSolid(*setup_.solid, voxel_mm)
                          : surface::UnionOfBalls(setup_.bone, voxel_mm);
    Begin();
    while (!stop_.load()) {
      const double wanted_s = wanted_s_.load();
      if (wanted_s < carved_s_) Begin();
      const bool more = !ended_ && wanted_s > carved_s_ && CarveOn(wanted_s);
      Publish();
      if (!more) std::this_thread::sleep_for(kPeriod);
    }
  } catch (const std::exception&) {  // a grid that no memory holds: the page stays without the bone
  }
}

void ViewSurface::Begin() {
  auto timeline = RecordingTimeline::Open(recording_);
  ended_ = !timeline;
  if (timeline) {
    timeline_ = std::make_unique<RecordingTimeline>(std::move(*timeline));
    (void)timeline_->Seek(0.0);
  }
  field_ = std::make_unique<surface::CarvedField>(solid_);
  ways_ = std::make_unique<surface::ToolWays>(setup_.config.tool.tool, setup_.X_WG);
  carved_s_ = 0.0;
  turns_ = false;
  sink_.Begin(field_->layout());
}

// Carves up to a time, or for kSlice. True if it has not got there.
bool ViewSurface::CarveOn(double wanted_s) {
  const auto until = Clock::now() + kSlice;
  for (int messages = 1; carved_s_ < wanted_s && !stop_.load(); ++messages) {
    const auto topic = timeline_->Next();
    if (!topic || *topic == io::RecordedTopic::kOther) {
      ended_ = true;
      break;
    }
    const io::RecordingStream& message = timeline_->message();
    if (*topic == io::RecordedTopic::kTick) {
      turns_ = message.tick.spindle_rad_per_s != 0.0;
      carved_s_ = timeline_->At(message.tick.stamp);
    }
    if (*topic == io::RecordedTopic::kFrame &&
        ways_->Add(surface::MakeToolFrame(message.frame.model, turns_ ? 1.0 : 0.0)))
      field_->Carve(ways_->TakeCapsules());
    if (messages % kMessagesPerLook == 0 && Clock::now() > until) return true;
  }
  return false;
}

void ViewSurface::Publish() {
  if (ended_ || carved_s_ >= wanted_s_.load()) field_->Carve(ways_->TakeCapsules());
  const auto dirty = field_->Dirty();
  if (!dirty.empty()) {
    if (chunks_.size() < dirty.size()) chunks_.resize(dirty.size());
    const auto material = [this](surface::Vec3 p_mm) {
      return setup_.solid ? setup_.solid->MaterialAt(1e-3 * Vector3(p_mm.x, p_mm.y, p_mm.z))
                          : std::uint8_t{0};
    };
    for (std::size_t i = 0; i < dirty.size(); ++i)
      surface::ExtractChunk(*field_, dirty[i], chunks_[i], {}, material);
    sink_.Publish(std::span(chunks_).first(dirty.size()), ways_->frame());
    field_->ClearDirty();
  }
  shown_s_.store(carved_s_);
}

}  // namespace osteon::app
