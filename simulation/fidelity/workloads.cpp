#include "simulation/fidelity/workloads.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "base/scramble.h"
#include "simulation/solids/box_solid.h"
#include "simulation/solids/shell_solid.h"

namespace osteon::simulation {
namespace {

constexpr double kTilt_rad = 20.0 * std::numbers::pi / 180.0;  // angle between the offset and the vertical
constexpr double kPressing_s = 0.05, kSettling_s = 0.05;  // durations: the offset grows; the tool settles
constexpr double kCircle_s = 0.4;   // duration in which the offset turns once, if the tool stays in place
constexpr double kLead_m = 0.5e-3;  // height above first contact at which a tool begins

// Cut zone of a flat top face, or of a part of it.
class TopZone final : public CutZone {
 public:
  [[nodiscard]] double DepthAt(const Vector3& p_m) const override { return -p_m.z(); }
};

// A tool of one cutting ball, whose apex is T's origin.
Tool OneBall(double radius_m) {
  Tool tool;
  tool.name = fmt::format("ball of {:g} mm", radius_m * 1e3);
  tool.balls.push_back({.center_m = Vector3(0, 0, -radius_m), .radius_m = radius_m, .cutting = true});
  tool.mass_kg = 1.0;
  return tool;
}

// Path of the ball's centre: straight down to a corner, then along a curve. `along` and `direction` are
// functions of the length travelled since the corner [m].
struct CenterWay {
  Vector3 start_m{Vector3::Zero()}, corner_m{Vector3::Zero()};  ///< ends of the straight part that leads down
  std::function<Vector3(double)> along{};                       ///< point on the curve; empty: no curve
  std::function<Vector3(double)> direction{};                   ///< unit tangent of the curve
  double along_m{0.0};                                          ///< length of the curve
};

// Random turn about the z axis, and displacement by up to `reach_m` along x and y, and down; none for seed 0.
Pose Jitter(std::uint64_t seed, double reach_m) {
  Pose X = Pose::Identity();
  if (seed == 0) return X;
  const auto draw = [&](std::uint64_t k) { return Uniform(Scramble(Scramble(seed) + k)); };
  X.linear() = Eigen::AngleAxisd(2.0 * std::numbers::pi * draw(0), Vector3::UnitZ()).toRotationMatrix();
  X.translation() = reach_m * Vector3(2.0 * draw(1) - 1.0, 2.0 * draw(2) - 1.0, -draw(3));
  return X;
}

// Makes the frames of a workload from the path of the ball's centre: the cut, and then the touch.
class Builder {
 public:
  Builder(CutWorkload& work, const CutWorkloadParams& params, double radius_m)
      : work_(work), params_(params), radius_m_(radius_m) {}

  // Adds all frames of the workload, and the exact forces.
  void Play(const CenterWay& way) {
    const double dt_s = 1.0 / params_.rate_hz, cut_step = params_.feed_m_per_s * dt_s;
    const double in_m = (way.corner_m - way.start_m).norm();
    const auto in_steps = Steps(in_m, cut_step), along_steps = Steps(way.along_m, cut_step);
    for (std::size_t k = 0; k <= in_steps; ++k)
      Add(way.start_m + Share(k, in_steps) * (way.corner_m - way.start_m), true);
    for (std::size_t k = 1; k <= along_steps; ++k) Add(way.along(Share(k, along_steps) * way.along_m), true);
    work_.cut_end = work_.frames.size();

    // Move the tool back along the curve or, if the path is only a hole, turn the offset in a circle.
    const bool trench = way.along_m > 0.0;
    const double feel_s = trench ? way.along_m / params_.feel_m_per_s : kCircle_s;
    const std::size_t rest = Frames(kPressing_s + kSettling_s), feel = Frames(feel_s);
    work_.feel_begin = work_.cut_end + rest;
    for (std::size_t k = 0; k < rest + feel; ++k) {
      // `pressed` is the fraction of the full offset, `gone` that of the way back or of the circle
      const double pressed = std::min(1.0, static_cast<double>(k + 1) * dt_s / kPressing_s);
      const double gone = k < rest ? 0.0 : Share(k - rest + 1, feel);
      const double at_m = (1.0 - gone) * way.along_m, turn = 2.0 * std::numbers::pi * gone;
      const Vector3 center = trench ? way.along(at_m) : way.corner_m;
      const Vector3 side = trench ? Vector3(way.direction(at_m).cross(Vector3::UnitZ()))
                                  : Vector3(std::cos(turn), std::sin(turn), 0.0);
      // in a trench, the offset swings to one side and then to the other
      const double tilt = trench ? kTilt_rad * std::sin(turn) : kTilt_rad;
      const Vector3 offset = params_.offset_m * (std::sin(tilt) * side - std::cos(tilt) * Vector3::UnitZ());
      Add(center + pressed * offset, false);
      if (work_.frames.size() <= work_.feel_begin) continue;
      const Vector3 force = -work_.cutting.stiffness_N_per_m * offset;
      // The force passes through the ball's centre, so any point of its line gives the torque.
      const Vector3 p_TC = R_WT() * Vector3(0, 0, -radius_m_);
      work_.exact.push_back({.f_N = force, .t_Nm = p_TC.cross(force)});
    }
  }

 private:
  // Number of equal steps that are at most `step_m` long.
  static std::size_t Steps(double length_m, double step_m) {
    return static_cast<std::size_t>(std::ceil(length_m / step_m - 1e-9));
  }
  static double Share(std::size_t k, std::size_t of) {
    return static_cast<double>(k) / static_cast<double>(of);
  }
  // Number of frames in this time.
  [[nodiscard]] std::size_t Frames(double seconds) const {
    return static_cast<std::size_t>(std::lround(seconds * params_.rate_hz));
  }
  // T's feed, +z, points down in W
  static Matrix3 R_WT() { return Eigen::DiagonalMatrix<double, 3>(1, -1, -1).toDenseMatrix(); }

  // Adds a frame with the ball's centre at this place.
  void Add(const Vector3& center_m, bool cuts) {
    Pose X_WT = Pose::Identity();
    X_WT.linear() = R_WT();
    X_WT.translation() = center_m - R_WT() * Vector3(0, 0, -radius_m_);
    const auto stamp = std::llround(static_cast<double>(work_.frames.size()) / params_.rate_hz * 1e9);
    work_.frames.push_back({.X_WT = X_WT,
                            .spindle_rad_per_s = cuts ? 100.0 : 0.0,
                            .dt_s = 1.0 / params_.rate_hz,
                            .stamp = static_cast<rt::Nanoseconds>(stamp)});
  }

  CutWorkload& work_;
  const CutWorkloadParams& params_;
  double radius_m_;
};

void Check(const CutWorkloadParams& params) {
  const auto check = [](const char* name, double value, double max) {
    if (!(value > 0.0 && value <= max))
      throw std::invalid_argument(
          fmt::format("cut workload: {}: found {:g}, accepted more than 0 up to {:g}", name, value, max));
  };
  check("rate [Hz]", params.rate_hz, 1e5);
  check("feed [m/s]", params.feed_m_per_s, 1.0);
  check("way back [m/s]", params.feel_m_per_s, 1.0);
  check("offset [m]", params.offset_m, 1e-3);
}

// Path straight down to a cut of this depth in a top face at z = 0, moved by X. The path begins 2 kLead_m
// above first contact, because X may move the path down by kLead_m.
CenterWay Down(const Pose& X, double radius_m, double depth_m) {
  const double bottom = radius_m - depth_m;
  return {.start_m = X * Vector3(0, 0, radius_m + 2.0 * kLead_m), .corner_m = X * Vector3(0, 0, bottom)};
}

}  // namespace

std::string_view TaskName(CutTask task) {
  switch (task) {
    case CutTask::kPlunge:
      return "plunge";
    case CutTask::kSlide:
      return "slide";
    case CutTask::kReam:
      return "ream";
    case CutTask::kChannel:
      return "channel";
    case CutTask::kScene:
      return "scene";
  }
  return "unknown";
}

std::vector<Pose> CutWorkload::CutPath() const {
  std::vector<Pose> path;
  for (std::size_t k = 0; k < cut_end; ++k) path.push_back(frames[k].X_WT);
  return path;
}

CutWorkload MakeCutWorkload(CutTask task, const CutWorkloadParams& params) {
  Check(params);
  // radii: ball of plunge and slide, burr, reamer; thickness of the cup's shell; radius of the channel's arc
  constexpr double kBall_m = 5e-3, kBurr_m = 1.5e-3, kReamer_m = 25e-3, kShell_m = 8e-3, kArc_m = 6e-3;
  CutWorkload work;
  work.task = task;
  work.rate_hz = params.rate_hz;
  work.cutting.law = RemovalLaw::kImmediate;
  work.materials = {DefaultBoneMaterials()[kCancellous]};
  work.materials[0].friction = 0.0;
  work.zone = std::make_shared<TopZone>();
  const Pose X = Jitter(params.seed, 0.5e-3);
  double radius_m = kBall_m;
  CenterWay way;
  switch (task) {
    case CutTask::kPlunge:
    case CutTask::kSlide: {
      work.solid = std::make_shared<BoxSolid>(
          BlockShape{.width_m = 0.020, .depth_m = 0.020, .height_m = 0.012, .layers = {}});
      way = Down(X, radius_m, 5e-3);
      if (task == CutTask::kPlunge) break;
      const Vector3 half = X.linear() * Vector3(3e-3, 0, 0);
      way.start_m -= half;
      way.corner_m -= half;
      const Vector3 corner = way.corner_m, direction = half.normalized();
      way.along = [corner, direction](double s) { return Vector3(corner + s * direction); };
      way.direction = [direction](double) { return direction; };
      way.along_m = 6e-3;
      break;
    }
    case CutTask::kChannel: {
      radius_m = kBurr_m;
      work.solid = std::make_shared<BoxSolid>(
          BlockShape{.width_m = 0.014, .depth_m = 0.014, .height_m = 0.006, .layers = {}});
      // a quarter of a circle around (-3.5, -3.5) mm, turned and moved
      const auto at = [X](double s) {
        const double angle = s / kArc_m;
        return Vector3(X * Vector3(kArc_m * std::cos(angle) - 3.5e-3, kArc_m * std::sin(angle) - 3.5e-3, 0));
      };
      way = Down(Pose::Identity(), radius_m, 2e-3);
      const Vector3 across = at(0.0), depth(0, 0, way.corner_m.z());
      way.start_m += across;
      way.corner_m += across;
      way.along = [at, depth](double s) { return Vector3(at(s) + depth); };
      way.direction = [X](double s) {
        const double angle = s / kArc_m;
        return Vector3(X.linear() * Vector3(-std::sin(angle), std::cos(angle), 0));
      };
      way.along_m = kArc_m * 0.5 * std::numbers::pi;
      break;
    }
    case CutTask::kReam: {
      radius_m = kReamer_m;
      work.solid = std::make_shared<ShellSolid>(kReamer_m, kReamer_m + kShell_m);
      work.zone =
          std::make_shared<CupZone>(CutSite{.center_m = Vector3(Vector3::Zero()), .radius_m = kReamer_m});
      // The tool fits only on the cup's axis, so the seed changes only the depth.
      const double depth_m = 3e-3 - X.translation().z();
      way = {.start_m = Vector3(0, 0, 0.1e-3), .corner_m = Vector3(0, 0, -depth_m)};
      break;
    }
    case CutTask::kScene:
      throw std::invalid_argument(
          "cut workload: found the task of a scene, accepted plunge, slide, ream, channel");
  }
  work.tool = OneBall(radius_m);
  Builder(work, params, radius_m).Play(way);
  return work;
}

WorkloadRun RunWorkload(CuttingEngine& engine, const CutWorkload& workload,
                        const std::function<bool(std::size_t)>& stop) {
  WorkloadRun run;
  for (std::size_t k = 0; k < workload.frames.size(); ++k) {
    if (stop && stop(k)) return run;
    const auto begun = std::chrono::steady_clock::now();
    const ContactModel model = engine.Step(workload.frames[k]);
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begun;
    if (model.status != EngineStatus::kOk) return run;
    const bool touched = model.contact_count > 0;
    if (touched) run.frame_us.push_back(took.count());
    if (k < workload.cut_end) run.removed_volume_m3 = model.removed_volume_m3;
    if (k >= workload.feel_begin)
      run.felt.push_back({.f_N = Vector3(model.F_T_W.f), .t_Nm = Vector3(model.F_T_W.t)});
  }
  run.complete = true;
  return run;
}

}  // namespace osteon::simulation
