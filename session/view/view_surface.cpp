#include "session/view/view_surface.h"

#include <chrono>
#include <span>
#include <utility>

#include "base/realtime_thread.h"
#include "simulation/surface/bone_solid.h"
#include "simulation/surface/dual_surface.h"

namespace osteon::session {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPeriod{40};  // how often the wanted time is checked
constexpr std::chrono::milliseconds kSlice{250};  // longest time of carving before the surface is updated
constexpr int kMessagesPerLook = 500;             // number of messages between two looks at the clock

}  // namespace

ViewSurface::ViewSurface(const std::filesystem::path& recording, const CellSetup& setup,
                         std::shared_ptr<const RecordedCut> cut, console::SurfaceFeed& feed,
                         std::unique_ptr<DifferenceMap> map)
    : recording_(recording),
      setup_(setup),
      cut_(std::move(cut)),
      feed_(feed),
      map_(std::move(map)),
      thread_([this] { Run(); }) {}

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
    tissue_.emplace(solid_->layout(), setup_.solid ? surface::TissueOf(setup_.solid) : surface::MaterialAt{});
    begin_.emplace(solid_, cut_);
    Begin(*begin_);
    keys_ = std::make_unique<CarvedKeys>(recording_, *begin_);
    while (!stop_.load()) {
      const double wanted_s = wanted_s_.load();
      keys_complete_.store(keys_->complete());
      if (map_ && map_->Switched()) {
        bone_->field.MarkAllDirty();
        BeginFeed();
      }
      GoNear(wanted_s);
      const bool has_more = !ended_ && wanted_s > bone_->at_s && CarveOn(wanted_s);
      Publish();
      if (!has_more) std::this_thread::sleep_for(kPeriod);
    }
  } catch (const std::exception&) {  // the grid is too large for the memory: the page stays without the bone
  }
}

void ViewSurface::Begin(const CarvedBone& from) {
  if (!timeline_)
    if (auto timeline = RecordingTimeline::Open(recording_))
      timeline_ = std::make_unique<RecordingTimeline>(std::move(*timeline));
  ended_ = !timeline_ || !GoOnFrom(from, *timeline_);
  if (bone_) return bone_->JumpTo(from);  // equal bricks are not sent again
  bone_.emplace(from);
  BeginFeed();
}

void ViewSurface::BeginFeed() {
  const surface::BrickLayout& layout = bone_->field.layout();
  if (map_) map_->Restart();
  if (map_ && map_->on())
    feed_.BeginDifference(layout, BoneDifference::StepFor(layout.voxel_mm));
  else
    feed_.Begin(layout);
}

// Jumps back to a key state or to the beginning if the wanted time is earlier than the bone shown. Jumps
// forward to a key state if that saves carving at least kFirstStep_s of the recording.
void ViewSurface::GoNear(double wanted_s) {
  const bool is_earlier = wanted_s < bone_->at_s;
  const std::shared_ptr<const CarvedBone> key = keys_->Before(wanted_s);
  if (key && (is_earlier || key->at_s > bone_->at_s + CarvedKeys::kFirstStep_s))
    Begin(*key);
  else if (is_earlier)
    Begin(*begin_);
}

// Reads on to a time, for at most kSlice. @returns whether more is to be read
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
  if (ended_ || bone_->at_s >= wanted_s_.load())
    bone_->CarveAll();
  else
    bone_->Carve();
  const auto dirty = bone_->field.Dirty();
  const std::vector<surface::BrickIndex> bricks =
      map_ ? map_->Update(bone_->field, solid_, dirty) : std::vector(dirty.begin(), dirty.end());
  if (!bricks.empty()) {
    if (chunks_.size() < bricks.size()) chunks_.resize(bricks.size());
    const bool is_map = map_ && map_->on();
    for (std::size_t i = 0; i < bricks.size(); ++i) {
      surface::ExtractChunk(bone_->field, bricks[i], chunks_[i], {},
                            is_map ? surface::MaterialAt{} : tissue_->OfBrick(bricks[i]));
      if (is_map) map_->Colour(bone_->field, chunks_[i]);
    }
    if (is_map) map_->TellLargest();
    feed_.Publish(std::span(chunks_).first(bricks.size()), bone_->sweep.frame());
    bone_->field.ClearDirty();
  }
  shown_s_.store(bone_->at_s);
}

}  // namespace osteon::session
