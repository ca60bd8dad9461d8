#include "session/foxglove/recorded_bone.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <iterator>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "base/realtime_thread.h"
#include "simulation/surface/bone_solid.h"
#include "simulation/surface/dual_surface.h"
#include "simulation/surface/millimetres.h"

namespace osteon::session {
namespace {

constexpr int kFieldTries = 6;  // number of grids that are tried, each coarser than the one before

// Counts the quads of the surface in the field's changed bricks. In a new field this is the whole surface.
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
      sweep_(setup.config.tool.tool, setup.X_WG),
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

void RecordedBone::UseTool(std::size_t tool) {
  if (tool == tool_ || tool >= params_.tools.size()) return;
  tool_ = tool;
  sweep_.UseTool(params_.tools[tool], gathered_);
}

void RecordedBone::Add(const simulation::ContactModel& model, bool spindle_turns) {
  sweep_.Add(surface::MakeToolFrame(model, spindle_turns ? 1.0 : 0.0), gathered_);
}

RecordedBone::Work RecordedBone::TakeWork(rt::Nanoseconds stamp) {
  return {.batches = std::exchange(gathered_, {}),
          .undone = params_.history.undone ? params_.history.undone() : UndonePasses(),
          .stamp = stamp};
}

const std::string* RecordedBone::Take(rt::Nanoseconds stamp) {
  last_stamp_ = stamp;
  std::unique_lock lock(mutex_);
  if (!busy_ && made_.empty() && (!next_ || stamp >= *next_)) {
    next_ = stamp + params_.step;
    Work work = TakeWork(stamp);
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
  sweep_.EndBatch(gathered_);
  // If a state is ready but was not taken, return it first, because the next state does not contain its
  // bricks.
  std::string before = std::exchange(made_, {});
  if (!before.empty()) {
    taken_ = std::move(before);
    return &taken_;
  }
  const Work rest = TakeWork(last_stamp_);
  if (begun_ && rest.batches.empty() && rest.undone == undone_) return nullptr;
  MakeState(rest);
  if (made_.empty()) return nullptr;
  taken_ = std::exchange(made_, {});
  return &taken_;
}

// Runs in the object's own thread: makes the states that Take begins, until Finish.
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

// Samples the uncut bone on a grid that is coarse enough for max_quads; null if none of the tried grids is.
std::shared_ptr<const surface::SolidField> RecordedBone::MakeSolidField() {
  for (int i = 0; i < kFieldTries; ++i) {
    try {
      auto solid = surface::FieldOfBone(solid_.get(), balls_, voxel_mm_);
      const std::size_t quads = QuadsOf(surface::CarvedField(solid));
      if (quads <= params_.max_quads) return solid;
      // the number of quads is inversely proportional to the square of the voxel size; add a margin of 5 %
      voxel_mm_ *= static_cast<float>(
          1.05 * std::sqrt(static_cast<double>(quads) / static_cast<double>(params_.max_quads)));
    } catch (const std::invalid_argument&) {  // the grid is too large for the memory
      voxel_mm_ *= 2.0F;
    }
  }
  return nullptr;
}

void RecordedBone::MakeField() {
  solid_field_ = MakeSolidField();
  no_field_ = !solid_field_;
  if (!no_field_) field_ = std::make_unique<surface::CarvedField>(CarveAnew());
}

// Carves the bone again from the uncut state: by the session's earlier recordings, then by the kept batches
// of passes that were not undone.
surface::CarvedField RecordedBone::CarveAnew() const {
  surface::CarvedField field(solid_field_);
  if (params_.history.carve_earlier) params_.history.carve_earlier(field);
  field.Carve(CapsulesOf(kept_, undone_.here));
  return field;
}

// Carves the work's batches into the bone. If bricks changed, encodes them as the message made_.
void RecordedBone::MakeState(const Work& work) try {
  if (!field_ && !no_field_) {
    undone_ = work.undone;
    MakeField();
  }
  if (no_field_) return;
  if (work.undone != undone_) {
    undone_ = work.undone;
    field_->SetSwept(CarveAnew().swept());
  }
  field_->Carve(CapsulesOf(work.batches, undone_.here));
  if (params_.history.undone)
    std::ranges::copy_if(work.batches, std::back_inserter(kept_),
                         [](const auto& batch) { return batch->touches; });
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
} catch (const std::exception& error) {  // for example, out of memory: the recording goes on without the bone
  no_field_ = true;
  error_ = error.what();
}

}  // namespace osteon::session
