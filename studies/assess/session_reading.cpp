#include "studies/assess/session_reading.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "base/read_text.h"
#include "base/units.h"
#include "io/recording/recording_reader.h"
#include "session/procedure/pass_detector.h"
#include "session/procedure/session_bone.h"
#include "session/procedure/wall_watch.h"

namespace osteon::studies {
namespace {

namespace fs = std::filesystem;
using procedure::ProcessSums;

constexpr double kNoStamp_s = -1.0;  // time stamp as long as no tick was read

// The carved state of a bone of which nothing was removed.
simulation::CarvedState Uncut(const simulation::Bone& bone) {
  simulation::CarvedState state;
  for (const simulation::Ball& ball : bone.balls)
    for (const double v : {ball.center_m.x, ball.center_m.y, ball.center_m.z, ball.radius_m})
      state.balls.push_back(static_cast<float>(1e3 * v));
  state.cleared.assign(bone.points.size(), 0);
  return state;
}

// Computes sums and curves over the recordings of a session, which are read one after the other.
class SessionSums {
 public:
  SessionSums(AssessedSession& session, const session::CellSetup& setup, double period_s)
      : session_(session),
        X_GW_(setup.X_WG.inverse()),
        period_s_(period_s),
        total_(session.plan.plan, period_s),
        walls_(session.bone, setup.solid.get(), session.plan.scene.events) {
    for (const double diameter_mm : session.file.diameters_mm) {
      session.tools.push_back({.diameter_mm = diameter_mm, .figures = {}});
      tools_.emplace_back(session.plan.plan, period_s);
    }
    for (const session::SessionPass& pass : session.file.passes) {
      session.passes.push_back({.pass = pass, .figures = {}});
      passes_.emplace_back(session.plan.plan, period_s);
      removed_mm3_.push_back(0.0);
      if (!pass.undone) last_tool_ = pass.tool_index;
      if (!pass.undone) ++session.tools[static_cast<std::size_t>(pass.tool_index)].passes;
    }
  }

  // Begins a recording. On the session's time axis, it follows the recording before.
  void Begin(const std::string& recording) {
    recording_ = recording;
    offset_s_ = last_s_ == kNoStamp_s ? 0.0 : last_s_ + period_s_;
    first_stamp_.reset();
    cutting_ = false;
    cut_.Restart();
    spindle_rad_per_s_ = 0.0;
  }

  // Adds a tick of the haptic phase to the sums of the session, its tool and its pass, and to the curves.
  void Add(const control::TickRecord& tick) {
    spindle_rad_per_s_ = tick.spindle_rad_per_s;
    if (tick.phase != control::Phase::kHaptic) return;
    if (!first_stamp_) first_stamp_ = tick.stamp;
    last_s_ = offset_s_ + rt::ToSeconds(tick.stamp - *first_stamp_);
    const int tool = ToolAt(tick.stamp);
    const Pose X_GT = X_GW_ * Pose(tick.X_WT_meas);
    const Vector3 feed = X_GT.linear().col(2);
    const procedure::ProcessSample sample{
        .t_s = last_s_,
        .head_m = X_GT.translation() - RadiusOf(tool) * feed,
        .cut_head_m = proxy_m_,
        .cut_feed = proxy_feed_,
        .F_hand_N = X_GW_.linear() * Vector3(tick.F_operator_T_W.f),
        .cutting = cutting_,
        .spindle_rad_per_s = tick.spindle_rad_per_s,
        .guidance_E_J = tick.guidance.present ? std::optional(tick.guidance.energy_J) : std::nullopt};
    const procedure::PlannedTool& reamer = session_.plan.plan.tools[static_cast<std::size_t>(tool)];
    total_.Add(sample, reamer);
    tools_[static_cast<std::size_t>(tool)].Add(sample, reamer);
    for (std::size_t i = 0; i < passes_.size(); ++i) {
      PassFigures& pass = session_.passes[i];
      if (!IsIn(pass.pass, tick.stamp)) continue;
      if (pass.end_s == 0.0) pass.begin_s = last_s_;
      pass.end_s = last_s_;
      passes_[i].Add(sample, reamer);
    }
    Trace(sample, feed, reamer);
  }

  // Adds a frame of the simulation: the volume removed, walls, and the reamed axis.
  void Add(const simulation::FrameRecord& frame) {
    cutting_ = cut_.Step(frame.model, spindle_rad_per_s_);
    const double new_m3 = std::max(0.0, cut_.removed_m3() - cut_.removed_before_m3());
    const rt::Nanoseconds stamp = frame.model.pose_stamp;
    for (std::size_t i = 0; new_m3 > 0.0 && i < passes_.size(); ++i)
      if (IsIn(session_.passes[i].pass, stamp)) removed_mm3_[i] += 1e9 * new_m3;
    const Pose X_GP = X_GW_ * Pose(frame.model.X_WP);
    const Vector3 feed = X_GP.linear().col(2);
    proxy_m_ = X_GP.translation() - RadiusOf(ToolAt(stamp)) * feed;
    proxy_feed_ = feed;
    session_.cut->Add(recording_, frame);
    if (!cutting_) return;
    for (const PassFigures& pass : session_.passes) {
      if (pass.pass.undone || !IsIn(pass.pass, stamp)) continue;
      walls_.Add(pass.pass.tool_index, RadiusOf(pass.pass.tool_index), proxy_m_);
      if (pass.pass.tool_index == last_tool_) axis_.Add(feed, new_m3);
    }
  }

  // Writes the sums into the session.
  void Finish() {
    procedure::Assessment& assessment = session_.assessment;
    assessment.process = total_.Figures();
    for (std::size_t i = 0; i < tools_.size(); ++i) session_.tools[i].figures = tools_[i].Figures();
    for (std::size_t i = 0; i < passes_.size(); ++i) session_.passes[i].figures = passes_[i].Figures();
    session_.missing = Missing();
    assessment.axis_G = axis_.value();
    assessment.min_wall_m = walls_.min_wall_m();
    if (const auto& cup = session_.file.cup_X_GT) {
      assessment.axis_G = -Pose(*cup).linear().col(2);
      assessment.axis_of_cup = true;
    }
  }

 private:
  // Whether a time of the present recording lies in the pass.
  [[nodiscard]] bool IsIn(const session::SessionPass& pass, rt::Nanoseconds stamp) const {
    const session::SessionSegment& segment = session_.file.segments[static_cast<std::size_t>(pass.segment)];
    return segment.recording == recording_ && stamp >= pass.begin && stamp <= pass.end;
  }
  // Names the counted passes whose recordings contain less than the removed volume: a recording may be
  // truncated, missing, or belong to another session.
  [[nodiscard]] std::string Missing() const {
    constexpr double kShare = 0.01, kLittle_mm3 = 1.0;  // accepted difference: 1 % and 1 mm³
    std::string text;
    for (std::size_t i = 0; i < passes_.size(); ++i) {
      const session::SessionPass& pass = session_.passes[i].pass;
      if (pass.undone || removed_mm3_[i] >= (1.0 - kShare) * pass.removed_mm3 - kLittle_mm3) continue;
      text += fmt::format("{}of pass {} {} holds {:.0f} of {:.0f} mm³", text.empty() ? "" : "; ", pass.number,
                          session_.file.segments[static_cast<std::size_t>(pass.segment)].recording,
                          removed_mm3_[i], pass.removed_mm3);
    }
    return text;
  }
  // The tool in use at a time: that of the last segment of this recording that has begun by this time.
  [[nodiscard]] int ToolAt(rt::Nanoseconds stamp) const {
    int tool = 0;
    bool found = false;
    for (const session::SessionSegment& segment : session_.file.segments)
      if (segment.recording == recording_ && (!found || stamp >= segment.begin)) {
        tool = segment.tool_index;
        found = true;
      }
    return tool;
  }
  [[nodiscard]] double RadiusOf(int tool) const {
    return 0.5e-3 * session_.file.diameters_mm[static_cast<std::size_t>(tool)];
  }
  // Adds a point to the curves, if the last point is at least kTraceStep_s old.
  void Trace(const procedure::ProcessSample& sample, const Vector3& feed,
             const procedure::PlannedTool& reamer) {
    SessionTrace& trace = session_.trace;
    if (!trace.t_s.empty() && sample.t_s < trace.t_s.back() + kTraceStep_s) return;
    const procedure::SurgicalPlan& plan = session_.plan.plan;
    const Vector3 from_planned_m = sample.head_m - plan.centre_m;
    const double height_m = from_planned_m.dot(plan.axis_G);
    trace.t_s.push_back(sample.t_s);
    trace.height_mm.push_back(1e3 * height_m);
    trace.aside_mm.push_back(1e3 * (from_planned_m - height_m * plan.axis_G).norm());
    trace.proxy_mm.push_back(1e3 * (proxy_m_ - plan.centre_m).dot(plan.axis_G));
    trace.tilt_deg.push_back(std::acos(std::clamp(-feed.dot(plan.axis_G), -1.0, 1.0)) / kDegree);
    trace.force_N.push_back(sample.F_hand_N.norm());
    if (!(plan.guidance.lateral.stop_m > 0.0)) return;
    const procedure::CorridorWidth width = procedure::WidthAt(plan, reamer, sample.head_m);
    trace.free_mm.push_back(1e3 * width.free_m);
    trace.stop_mm.push_back(1e3 * width.stop_m);
  }

  AssessedSession& session_;
  Pose X_GW_;
  double period_s_;
  ProcessSums total_;
  std::vector<ProcessSums> tools_, passes_;
  std::vector<double> removed_mm3_;  // volume that each pass removed, according to the recordings
  session::WallWatch walls_;
  procedure::ReamedAxis axis_;
  int last_tool_{0};
  std::string recording_;
  double offset_s_{0.0}, last_s_{kNoStamp_s};
  std::optional<rt::Nanoseconds> first_stamp_;
  bool cutting_{false};
  Vector3 proxy_m_{Vector3::Zero()}, proxy_feed_{Vector3::Zero()};  ///< simulated head in the last frame
  session::CutDetector cut_;
  double spindle_rad_per_s_{0.0};  // spindle speed in the last tick
};

// The first recording that has begun; if none has, the recording of the first segment.
std::string FirstRecording(const AssessedSession& session) {
  const std::vector<std::string> begun = session::BegunRecordings(session.file, session.folder);
  return begun.empty() ? session.file.segments.front().recording : begun.front();
}

// The cutting heads of the plan's reamers. Each is a ball whose centre is half its diameter behind T's
// origin.
std::vector<simulation::Tool> CuttingHeads(const std::vector<double>& diameters_mm) {
  std::vector<simulation::Tool> heads;
  for (const double diameter_mm : diameters_mm) {
    const double radius_m = 0.5e-3 * diameter_mm;
    heads.emplace_back().balls = {
        {.center_m = Vector3(0.0, 0.0, -radius_m), .radius_m = radius_m, .cutting = true}};
  }
  return heads;
}

// Refuses a session whose plan was changed, that has no segment, or whose tools are not the plan's.
tl::expected<void, std::string> CheckSession(const AssessedSession& session) {
  const fs::path file = session.folder / session.file.plan_file;
  if (const std::string found = session::TextChecksum(base::ReadText(file));
      found != session.file.plan_checksum)
    return tl::make_unexpected(
        fmt::format("{}: found checksum {}, accepted the session's, {}: the plan was changed", file.string(),
                    found, session.file.plan_checksum));
  if (session.file.segments.empty())
    return tl::make_unexpected(fmt::format("{}: found no segment, accepted at least one",
                                           (session.folder / session::kSessionFileName).string()));
  if (session.file.diameters_mm.size() != session.plan.plan.tools.size())
    return tl::make_unexpected(fmt::format("{}: found {} reamers, accepted the plan's {}",
                                           (session.folder / session::kSessionFileName).string(),
                                           session.file.diameters_mm.size(), session.plan.plan.tools.size()));
  return {};
}

}  // namespace

tl::expected<AssessedSession, std::string> ReadAssessedSession(const fs::path& folder) {
  auto file = session::ReadSession(folder);
  if (!file) return tl::make_unexpected(file.error());
  AssessedSession session{.folder = folder, .file = std::move(*file)};
  session.plan = config::LoadSurgicalPlan(folder / session.file.plan_file);
  if (!session.file.plan_name.empty()) session.plan.plan.name = session.file.plan_name;
  if (const auto right = CheckSession(session); !right) return tl::make_unexpected(right.error());
  auto setup = session::SetUpSessionCell(folder / FirstRecording(session));
  if (!setup) return tl::make_unexpected(setup.error());
  session.bone = std::move(setup->bone);
  session.solid = setup->solid;
  session.cut.emplace(session.file, CuttingHeads(session.file.diameters_mm), setup->X_WG);
  if (const std::string last = session.file.LastState(); last.empty()) {
    session.state = Uncut(session.bone);
  } else {
    auto state = session::ReadSessionState(folder, session.file, last, session.bone);
    if (!state) return tl::make_unexpected(state.error());
    session.state = std::move(*state);
  }
  for (const session::SessionSegment& segment : session.file.segments)
    session.guidance_gain = std::max(session.guidance_gain, segment.guidance_gain);

  SessionSums sums(session, *setup, setup->config.servo.period_s);
  for (const std::string& recording : session::BegunRecordings(session.file, folder)) {
    auto stream = io::RecordingStream::Open(folder / recording);
    if (!stream) return tl::make_unexpected(stream.error());
    sums.Begin(recording);
    while (true) {
      const auto topic = stream->Next();
      if (!topic) return tl::make_unexpected(topic.error());
      if (*topic == io::RecordedTopic::kOther) break;
      if (*topic == io::RecordedTopic::kTick) sums.Add(stream->tick);
      if (*topic == io::RecordedTopic::kFrame) sums.Add(stream->frame);
    }
  }
  sums.Finish();
  procedure::AssessBone(session.plan.plan, session.bone, session.state, session.assessment);
  return session;
}

}  // namespace osteon::studies
