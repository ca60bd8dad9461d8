#include "plugin/src/session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "base/clock.h"
#include "base/paced_priority.h"
#include "base/realtime_thread.h"
#include "base/utf8.h"
#include "plugin/src/convert.h"
#include "plugin/src/engine_lock.h"
#include "plugin/src/result.h"
#include "plugin/src/saved_files.h"
#include "session/setup/engine_choice.h"
#include "simulation/engine/tool_change.h"
#include "simulation/files/carved_file.h"
#include "simulation/surface/bone_solid.h"
#include "simulation/surface/surface_export.h"
#include "simulation/surface/swept_file.h"

namespace osteon::plugin {
namespace {

using simulation::CarvedState;
using simulation::EngineStatus;

constexpr std::size_t kMaxMarks = 16;    // most marks for undo; a further mark replaces the oldest
constexpr std::size_t kMaxEvents = 256;  // most events that wait for next_event; further ones are only logged
// In lockstep, number of frames between two waits for the surface's thread: half the size of its ring.
constexpr std::uint64_t kFramesAhead = 2048;
constexpr double kMaxFrame_s = 0.1;       // longest time for which a single frame may cut
constexpr double kMaxOverlap_m = 0.1e-3;  // a tool that is no deeper in bone counts as free

const char* EngineName(std::uint32_t engine) {
  switch (engine) {
    case OSTEON_ENGINE_AUTO:
      return "auto";
    case OSTEON_ENGINE_CPU:
      return "cpu";
    case OSTEON_ENGINE_VULKAN:
      return "vulkan";
  }
  throw Failure(OSTEON_ERROR_ARGUMENT, fmt::format("engine: found {}, accepted an OsteonEngine", engine));
}

/// Returns the value. @throws Failure if it is not above 0 and at most `most`.
double Checked(const char* name, double value, double most) {
  if (!(value > 0.0 && value <= most))
    throw Failure(OSTEON_ERROR_ARGUMENT,
                  fmt::format("{}: found {}, accepted above 0, at most {}", name, value, most));
  return value;
}

/// Depth of a tool at this pose in the bone's balls [m]; 0: the tool is free.
double Overlap(const CarvedState& state, const simulation::Tool& tool, const Pose& X_GT) {
  return std::max(0.0, -simulation::ToolClearance(state, tool, X_GT));
}

OsteonEvent EventOf(const simulation::SceneEvent& event, std::uint64_t frame) {
  OsteonEvent result{};
  CopyText(result.name, event.name);
  result.value_m = event.value;
  result.position_m[0] = event.p_G_m.x;
  result.position_m[1] = event.p_G_m.y;
  result.position_m[2] = event.p_G_m.z;
  result.frame = frame;
  return result;
}

/// Why the engine computes no frames, as a text; null if it computes frames.
const char* FailureText(EngineStatus status) {
  if (status == EngineStatus::kDeviceLost) return "the GPU was lost: destroy the session";
  if (status == EngineStatus::kOverloaded)
    return "more bone within the tool's reach than the engine has room for";
  return nullptr;
}

}  // namespace

Session::Session(std::shared_ptr<const BoneSource> bone, std::shared_ptr<const ToolSource> tool,
                 const OsteonSettings& settings)
    : bone_(std::move(bone)),
      is_lockstep_(settings.lockstep != 0),
      process_(getpid()),
      limiter_({.max_force_N = Checked("max_force_N", settings.max_force_N, safety::kForceCeiling_N),
                .max_torque_Nm = Checked("max_torque_Nm", settings.max_torque_Nm, 20.0)}),
      tool_(std::move(tool)) {
  coupling_.max_stiffness_N_per_m = Checked("stiffness_N_per_m", settings.stiffness_N_per_m, 1e6);
  coupling_.damping_Ns_per_m = settings.damping_Ns_per_m;
  control::Validate(coupling_);
  cutting_.stiffness_N_per_m = settings.stiffness_N_per_m;
  cutting_.max_force_N = settings.max_force_N;
  const session::EngineChoice choice =
      session::ChooseEngine(EngineName(settings.engine), settings.device ? settings.device : "");
  engine_name_ = choice.engine;
  device_ = choice.device;
  engine_ = MakeEngine(*tool_);
  engine_text_ = session::EngineText(choice, engine_->device());
  if (simulation::CuttingHead(tool_->tool)) depth_.emplace(bone_->bone, tool_->tool);
  watch_.emplace(bone_->solid.get(), bone_->bone, tool_->tool, bone_->events);
  if (settings.surface != 0) {
    surface::SurfaceThreadParams params;
    const float voxel_mm = surface::VoxelFor(tool_->tool);
    params.make_solid = [source = bone_, voxel_mm] {
      return surface::FieldOfBone(source->solid.get(), source->bone, voxel_mm);
    };
    if (bone_->solid) params.material = surface::TissueOf(bone_->solid);
    surface_ =
        std::make_unique<surface::SurfaceThread>(tool_->tool, Pose::Identity(), std::move(params), mailbox_);
  }
  if (!is_lockstep_)
    thread_ = std::thread([this] {
      try {
        Loop();
      } catch (const std::exception& error) {
        const std::lock_guard lock(engine_mutex_);
        error_ = error.what();
        Log(OSTEON_LOG_ERROR, "the engine's thread has ended: " + error_);
      }
    });
}

Session::~Session() {
  stop_.store(true);
  if (thread_.joinable()) thread_.join();
}

std::unique_ptr<simulation::CuttingEngine> Session::MakeEngine(const ToolSource& tool) const {
  auto engine = session::MakeEngine({.engine = engine_name_, .device = device_}, bone_->bone, tool.tool,
                                    Pose::Identity(), cutting_);
  if (!engine) throw Failure(OSTEON_ERROR_DEVICE, engine.error());
  return std::move(*engine);
}

void Session::SetToolPose(const OsteonPose& pose, double spindle_rad_per_s) noexcept {
  spindle_on_.store(spindle_rad_per_s != 0.0, std::memory_order_relaxed);
  commands_.Store(
      {.X_WT = InBone(ToPose(pose)), .spindle_rad_per_s = spindle_rad_per_s, .stamp = rt::MonotonicNow()});
}

void Session::Loop() {
  rt::NameThread("osteon engine");
  rt::PacedPriority priority;
  rt::Nanoseconds done_stamp = 0;
  while (!stop_.load(std::memory_order_relaxed)) {
    const simulation::ToolCommand command = commands_.Load();
    const rt::Nanoseconds start = rt::MonotonicNow();
    // sleep if there is no new pose, or if another thread needs the engine
    if (command.stamp == done_stamp || waiting_.load() > 0) {
      rt::SleepUntil(start + 50'000);  // 50 us: poses come about once a millisecond
      continue;
    }
    const std::lock_guard lock(engine_mutex_);
    done_stamp = command.stamp;
    if (command.stamp <= continued_) continue;  // the pose is older than the last change of tool or bone
    const double dt_s = last_stamp_ == 0 ? 0.0 : rt::ToSeconds(command.stamp - last_stamp_);
    ComputeFrame(command, std::clamp(dt_s, 0.0, kMaxFrame_s));
    const rt::Nanoseconds end = rt::MonotonicNow();
    frame_time_s_ = rt::ToSeconds(end - start);
    priority.CountWork(end);
  }
}

void Session::ComputeFrame(const simulation::ToolCommand& command, double dt_s) {
  if (newest_.frame == 0) {  // the first pose must be free of bone
    const double overlap_m = Overlap(engine_->Snapshot(), tool_->tool, command.X_WT);
    const bool was_in_bone = in_bone_at_start_m_ > 0.0;
    in_bone_at_start_m_ = overlap_m > kMaxOverlap_m ? overlap_m : 0.0;
    if (in_bone_at_start_m_ > 0.0) {
      if (!was_in_bone) Log(OSTEON_LOG_WARNING, InBoneText());
      return;
    }
  }
  last_stamp_ = command.stamp;
  const double removed_m3 = newest_.frame == 0 ? 0.0 : newest_.removed_volume_m3;
  newest_ = engine_->Step({.X_WT = command.X_WT,
                           .spindle_rad_per_s = command.spindle_rad_per_s,
                           .dt_s = dt_s,
                           .stamp = command.stamp});
  models_.Store(newest_);
  if (surface_) {
    (void)surface_->Push(surface::MakeToolFrame(newest_, command.spindle_rad_per_s));
    // In lockstep frames are computed without pauses and could fill the ring of the surface's thread, so wait
    // for that thread now and then.
    if (is_lockstep_ && newest_.frame % kFramesAhead == 0) WaitForSurface();
  }
  if (newest_.status != EngineStatus::kOk) {
    if (const char* text = FailureText(newest_.status); text && !has_logged_failure_) {
      Log(OSTEON_LOG_ERROR, text);
      has_logged_failure_ = true;
    }
    return;
  }
  // add the tool's axis in this frame, weighted by the volume that the frame removed
  if (const double new_m3 = newest_.removed_volume_m3 - removed_m3; new_m3 > 0.0) {
    if (std::exchange(axis_of_tool_before_, false)) axis_ = {};
    axis_.Add(Pose(newest_.X_WP).linear().col(2), new_m3);
  }
  for (const simulation::SceneEvent& event :
       watch_->Step(Pose(newest_.X_WP), newest_.removed_volume_m3, command.stamp)) {
    if (events_.size() < kMaxEvents) events_.push_back(EventOf(event, newest_.frame));
    Log(OSTEON_LOG_INFO,
        fmt::format("frame {}: {}, {:.2f} mm", newest_.frame, event.name, 1e3 * event.value));
  }
}

void Session::SetLog(OsteonLogCallback callback, void* user) {
  const EngineLock lock(*this);
  log_ = callback;
  log_user_ = user;
  Log(OSTEON_LOG_INFO, "engine: " + engine_text_);
  if (!bone_->warning.empty()) Log(OSTEON_LOG_WARNING, bone_->warning);
}

void Session::Log(OsteonLogLevel level, const std::string& text) const {
  if (!log_) return;
  try {
    log_(log_user_, static_cast<std::uint32_t>(level), base::Utf8(text).c_str());
  } catch (...) {  // an exception of the host's callback ends neither the call nor the engine's thread
  }
}

std::string Session::InBoneText() const {
  return fmt::format(
      "the session's first pose: found the tool {:.2f} mm in bone, accepted a pose free of bone (0.1 mm)",
      1e3 * in_bone_at_start_m_);
}

void Session::Step(const Pose& X_GT, double spindle_rad_per_s, double dt_s) {
  if (!is_lockstep_)
    throw Failure(OSTEON_ERROR_STATE, "step: the session has a thread of its own; create it with lockstep 1");
  if (!(dt_s >= 0.0 && dt_s <= kMaxFrame_s))
    throw Failure(OSTEON_ERROR_ARGUMENT, fmt::format("dt_s: found {}, accepted 0 … {}", dt_s, kMaxFrame_s));
  const EngineLock lock(*this);
  spindle_on_.store(spindle_rad_per_s != 0.0, std::memory_order_relaxed);
  const rt::Nanoseconds now = clock_.load() + static_cast<rt::Nanoseconds>(std::llround(1e9 * dt_s));
  clock_.store(now);
  ComputeFrame({.X_WT = InBone(X_GT), .spindle_rad_per_s = spindle_rad_per_s, .stamp = now}, dt_s);
  CheckDevice();
}

void Session::CheckDevice() const {
  if (!error_.empty()) throw Failure(OSTEON_ERROR_INTERNAL, "the engine's thread has ended: " + error_);
  if (in_bone_at_start_m_ > 0.0) throw Failure(OSTEON_ERROR_STATE, InBoneText());
  if (const char* text = FailureText(newest_.status)) throw Failure(OSTEON_ERROR_DEVICE, text);
}

OsteonFigures Session::Figures() {
  const EngineLock lock(*this);
  CheckDevice();
  const rt::Nanoseconds now = is_lockstep_ ? clock_.load() : rt::MonotonicNow();
  OsteonFigures figures{};
  figures.frame = newest_.frame;
  figures.pose_age_s = newest_.frame == 0 ? 0.0 : rt::ToSeconds(now - newest_.pose_stamp);
  figures.frame_time_s = frame_time_s_;
  if (newest_.frame > 0) figures.proxy = FromPose(newest_.X_WP);
  figures.wrench = FromWrench(newest_.F_T_W);
  figures.removed_volume_m3 = newest_.removed_volume_m3;
  figures.removed_mass_kg = newest_.removed_mass_kg;
  figures.cutting_work_J = newest_.cutting_work_J;
  figures.spindle_torque_Nm = newest_.spindle_torque_Nm;
  figures.engaged_area_m2 = newest_.engaged_area_m2;
  figures.depth_m = depth_ && newest_.frame > 0 ? depth_->DepthAt(newest_.X_WP) : 0.0;
  figures.contacts = static_cast<std::uint32_t>(newest_.contact_count);
  figures.skipped_on_surface = surface_ ? surface_->skipped_frames() : 0;
  return figures;
}

std::optional<OsteonEvent> Session::NextEvent() {
  const EngineLock lock(*this);
  if (events_.empty()) return std::nullopt;
  const OsteonEvent event = events_.front();
  events_.pop_front();
  return event;
}

void Session::ApplyToSurface(
    const std::function<void(surface::CarvedField&, surface::ToolSweep&)>& change) try {
  surface_->Apply(change);
} catch (const Failure&) {
  throw;
} catch (const std::runtime_error& error) {
  throw Failure(OSTEON_ERROR_STATE,
                fmt::format("surface: its thread has ended: {}; create the session with settings.surface = 0",
                            error.what()));
}

void Session::AwaitField() {
  if (surface_) ApplyToSurface([](surface::CarvedField&, surface::ToolSweep&) {});
}

surface::BrickLayout Session::SurfaceLayout() {
  surface::BrickLayout layout;
  ApplyToSurface([&](surface::CarvedField& field, surface::ToolSweep&) { layout = field.layout(); });
  return layout;
}

Session::Saved Session::Remember() {
  Saved saved{.state = engine_->Snapshot(), .swept = std::nullopt, .axis = axis_, .min_wall_m = MinWall()};
  if (surface_)
    ApplyToSurface([&](surface::CarvedField& field, surface::ToolSweep&) { saved.swept = field.swept(); });
  return saved;
}

void Session::Continue(std::shared_ptr<const ToolSource> tool, Saved saved, const Pose& X_GT) {
  const double overlap_m = Overlap(saved.state, tool->tool, X_GT);
  if (overlap_m > kMaxOverlap_m)
    throw Failure(
        OSTEON_ERROR_STATE,
        fmt::format("pose: found the tool {:.2f} mm in bone, accepted a pose free of bone (0.1 mm): "
                    "move the tool out first",
                    1e3 * overlap_m));
  auto engine = MakeEngine(*tool);
  // no contact of the saved state is kept: the tool starts at its present pose
  engine->Restore(simulation::WithoutContact(std::move(saved.state)));
  const rt::Nanoseconds now = is_lockstep_ ? clock_.load() : rt::MonotonicNow();
  const simulation::ContactModel first = engine->Step({.X_WT = X_GT, .dt_s = 0.0, .stamp = now});
  if (first.status != EngineStatus::kOk)
    throw Failure(OSTEON_ERROR_DEVICE, "the engine cannot compute a frame at this pose");
  std::optional<simulation::ApexDepth> depth;
  if (simulation::CuttingHead(tool->tool)) depth.emplace(bone_->bone, tool->tool);
  std::optional<simulation::SceneWatch> watch;
  watch.emplace(bone_->solid.get(), bone_->bone, tool->tool, bone_->events);
  const Levels levels = LevelsFor(*tool);
  const std::string text = fmt::format("continues with {} at frame {}", tool->tool.name, first.frame);
  surface::ToolSweep begun(tool->tool, Pose::Identity());
  if (surface_)  // the last step that can fail: a tool that is refused must not carve the surface
    ApplyToSurface([&](surface::CarvedField& field, surface::ToolSweep& sweep) {
      if (saved.swept) field.SetSwept(std::move(*saved.swept));
      sweep = std::move(begun);
    });

  // nothing throws from here on: the session takes the new tool and bone
  engine_ = std::move(engine);
  tool_ = std::move(tool);
  depth_ = depth;
  watch_.emplace(std::move(*watch));
  axis_ = saved.axis;
  axis_of_tool_before_ = false;
  min_wall_m_ = saved.min_wall_m;
  newest_ = first;
  in_bone_at_start_m_ = 0.0;  // the session continues at this pose, which is free of bone
  models_.Store(newest_);
  UseLevels(levels);
  last_stamp_ = continued_ = now;
  Log(OSTEON_LOG_INFO, text);
}

void Session::ChangeTool(std::shared_ptr<const ToolSource> tool, const Pose& X_GT) {
  AwaitField();
  const EngineLock lock(*this);
  Continue(std::move(tool), Remember(), X_GT);
  axis_of_tool_before_ = true;
}

std::optional<double> Session::MinWall() const {
  std::optional<double> wall_m = watch_->min_wall_m();
  if (min_wall_m_) wall_m = std::min(wall_m.value_or(*min_wall_m_), *min_wall_m_);
  return wall_m;
}

procedure::Assessment Session::Assess(const procedure::SurgicalPlan& plan) {
  if (const std::string wrong = procedure::SiteError(plan, bone_->bone.site); !wrong.empty())
    throw Failure(OSTEON_ERROR_ARGUMENT, fmt::format("plan {}: {}", plan.name, wrong));
  procedure::Assessment assessment;
  CarvedState state;
  {
    const EngineLock lock(*this);
    state = engine_->Snapshot();
    assessment.axis_G = axis_.value();
    assessment.min_wall_m = MinWall();
  }
  procedure::AssessBone(plan, bone_->bone, state, assessment);
  return assessment;
}

void Session::Mark() {
  AwaitField();
  const EngineLock lock(*this);
  if (marks_.size() == kMaxMarks) marks_.pop_front();
  marks_.push_back(Remember());
}

void Session::Undo(const Pose& X_GT) {
  AwaitField();
  const EngineLock lock(*this);
  if (marks_.empty())
    throw Failure(OSTEON_ERROR_STATE, "undo: found no mark, accepted after osteon_session_mark");
  Continue(tool_, marks_.back(), X_GT);
  marks_.pop_back();
}

void Session::Save(const std::string& file) {
  CheckSaveName(file);
  if (surface_) CheckSaveName(SweptFileOf(file));
  AwaitField();
  Saved saved;
  {
    const EngineLock lock(*this);
    saved = Remember();
  }
  // The surface's file gets its final name last, so that an earlier pair of files stays if the bone cannot be
  // written.
  const SweptPart part(file);
  if (surface_) {
    if (const auto written = surface::WriteSweptField(part.file(), *saved.swept, SurfaceLayout()); !written)
      throw Failure(OSTEON_ERROR_FILE, written.error().Text());
  }
  if (const auto written = simulation::WriteCarvedState(file, saved.state, bone_->bone); !written)
    throw Failure(OSTEON_ERROR_FILE, written.error().Text());
  if (surface_) part.Commit();
}

void Session::Restore(const std::string& file, const Pose& X_GT) {
  auto state = simulation::ReadCarvedState(file, bone_->bone);
  if (!state) throw Failure(OSTEON_ERROR_FILE, state.error().Text());
  Saved saved{.state = std::move(*state), .swept = std::nullopt, .axis = {}, .min_wall_m = std::nullopt};
  if (surface_) {
    auto swept = surface::ReadSweptField(SweptFileOf(file), SurfaceLayout());
    if (!swept) throw Failure(OSTEON_ERROR_FILE, swept.error().Text());
    saved.swept = std::move(*swept);
  }
  const EngineLock lock(*this);
  Continue(tool_, std::move(saved), X_GT);
}

const SurfaceMailbox& Session::mailbox() const {
  if (!surface_)
    throw Failure(OSTEON_ERROR_STATE,
                  "surface: found a session without one, accepted after settings.surface = 1");
  return mailbox_;
}

void Session::WaitForSurface() {
  (void)mailbox();
  AwaitField();
}

OsteonSurfaceInfo Session::ExportSurface(const std::string& file) {
  (void)mailbox();
  if (const std::string wrong = surface::ValidateSurfaceName(file); !wrong.empty())
    throw Failure(OSTEON_ERROR_ARGUMENT, "file: " + wrong);
  OsteonSurfaceInfo info{};
  ApplyToSurface([&](surface::CarvedField& field, surface::ToolSweep&) {
    const auto written = surface::WriteSurface(file, field);
    if (!written) throw Failure(OSTEON_ERROR_FILE, written.error().Text());
    info = {.triangles = written->triangles,
            .volume_m3 = 1e-9 * written->volume_mm3,
            .watertight = static_cast<std::uint32_t>(written->watertight ? 1 : 0),
            .reserved = 0};
  });
  return info;
}

}  // namespace osteon::plugin
