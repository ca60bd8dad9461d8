#include "session/foxglove/recorded_bone.h"

#include <cmath>
#include <exception>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "base/realtime_thread.h"
#include "simulation/surface/bone_solid.h"
#include "simulation/surface/dual_surface.h"
#include "simulation/surface/millimetres.h"

namespace osteon::session {
namespace {

constexpr int kFieldTries = 6;

std::size_t QuadsOf(const surface::CarvedField& field) {
  std::size_t quads = 0;
  surface::SurfaceChunk chunk;
  for (const surface::BrickIndex brick : field.Dirty()) {
    surface::ExtractChunk(field, brick, chunk);
    quads += chunk.quads.size() / 4;
  }
  return quads;
}

}  // namespace

RecordedBone::RecordedBone(const CellSetup& setup, const CellScene& scene, RecordedBoneParams params)
    : scene_(scene),
      params_(params),
      solid_(setup.solid),
      balls_(setup.solid ? simulation::Bone() : setup.bone),
      ways_(setup.config.tool.tool, setup.X_WG),
      voxel_mm_(surface::VoxelFor(setup.config.tool.tool)) {
  if (params_.own_thread) thread_ = std::thread([this] { Run(); });
}

RecordedBone::~RecordedBone() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void RecordedBone::Add(const simulation::ContactModel& model, bool spindle_turns) {
  if (!ways_.Add(surface::MakeToolFrame(model, spindle_turns ? 1.0 : 0.0))) return;
  const std::vector<surface::Capsule> swept = ways_.TakeCapsules();
  gathered_.insert(gathered_.end(), swept.begin(), swept.end());
}

const std::string* RecordedBone::Take(rt::Nanoseconds stamp) {
  last_stamp_ = stamp;
  std::unique_lock lock(mutex_);
  if (!busy_ && made_.empty() && (!next_ || stamp >= *next_)) {
    next_ = stamp + params_.step;
    Work work{.capsules = std::exchange(gathered_, {}), .stamp = stamp};
    if (params_.own_thread) {
      work_ = std::move(work);
      busy_ = true;
      wake_.notify_all();
    } else {
      lock.unlock();
      MakeState(work);
      lock.lock();
    }
  }
  if (made_.empty()) return nullptr;
  taken_ = std::exchange(made_, {});
  return &taken_;
}

const std::string* RecordedBone::Finish() {
  if (thread_.joinable()) {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    wake_.notify_all();
    thread_.join();
  }
  const std::vector<surface::Capsule> rest = ways_.TakeCapsules();
  gathered_.insert(gathered_.end(), rest.begin(), rest.end());
  std::string before = std::exchange(made_, {});  // a state that nobody took: bricks that the next one lacks
  if (!before.empty()) {
    taken_ = std::move(before);
    return &taken_;
  }
  if (gathered_.empty() && begun_) return nullptr;
  MakeState({.capsules = std::exchange(gathered_, {}), .stamp = last_stamp_});
  if (made_.empty()) return nullptr;
  taken_ = std::exchange(made_, {});
  return &taken_;
}

void RecordedBone::Run() {
  rt::NameThread("recorded bone");
  rt::LowerPriority();
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return stop_ || work_; });
    if (work_) {
      const Work work = std::move(*work_);
      work_.reset();
      lock.unlock();
      MakeState(work);
      lock.lock();
      busy_ = false;
    } else if (stop_) {
      return;
    }
  }
}

std::unique_ptr<surface::CarvedField> RecordedBone::MakeField() {
  for (int i = 0; i < kFieldTries; ++i) {
    try {
      auto field =
          std::make_unique<surface::CarvedField>(surface::FieldOfBone(solid_.get(), balls_, voxel_mm_));
      const std::size_t quads = QuadsOf(*field);
      if (quads <= params_.max_quads) return field;
      voxel_mm_ *= static_cast<float>(
          1.05 * std::sqrt(static_cast<double>(quads) / static_cast<double>(params_.max_quads)));
    } catch (const std::invalid_argument&) {  // a grid that no memory holds
      voxel_mm_ *= 2.0F;
    }
  }
  return nullptr;
}

void RecordedBone::MakeState(const Work& work) try {
  if (!field_ && !no_field_) {
    field_ = MakeField();
    no_field_ = !field_;
  }
  if (no_field_) return;
  field_->Carve(work.capsules);
  const auto material = [this](surface::Vec3 p_mm) {
    return solid_ ? static_cast<std::uint8_t>(solid_->MaterialAt(surface::ToMetres(p_mm))) : std::uint8_t{0};
  };
  std::vector<io::SceneEntity> parts;
  surface::SurfaceChunk chunk;
  for (const surface::BrickIndex brick : field_->Dirty()) {
    surface::ExtractChunk(*field_, brick, chunk, {}, material);
    parts.push_back(scene_.BonePart(fmt::format("brick_{}", chunk.brick), {&chunk, 1}));
  }
  field_->ClearDirty();
  if (parts.empty()) return;
  std::string bytes;
  io::EncodeScene(work.stamp, parts, !std::exchange(begun_, true), bytes);
  const std::lock_guard lock(mutex_);
  made_ = std::move(bytes);
} catch (const std::exception&) {  // out of memory: the recording goes on without the bone
  no_field_ = true;
}

}  // namespace osteon::session
