#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "control/coupling/virtual_coupling.h"
#include "simulation/bone/scenes.h"
#include "simulation/engine/reference_engine.h"
#include "studies/failures/contact_bench.h"
#include "studies/failures/scenario_bench.h"

// Compares the force that the servo loop renders with that of an ideal wall, corner and cup at the same
// tick's pose. The bone is packed with balls; the engine's frames, at 500 Hz, arrive 3 ms after their pose;
// the coupling runs each millisecond. Lengths are in metres, W and G coincide, and the spindle stands still.

namespace osteon::studies {
namespace {

constexpr double kK = 20e3;        // stiffness of the engine's contacts [N/m]
constexpr int kFrameEvery_ms = 2;  // 500 Hz
constexpr int kFrameTakes_ms = 3;
constexpr int kApproach_ms = 300, kHold_ms = 300, kAfter_ms = 100;
constexpr int kNoticed_ms = 10;  // assumed time after which a hand notices a step

/// A path of the tool's apex (an approach, a rest under pressure, and a sudden step), with the ideal bone's
/// force.
struct Course {
  simulation::Bone bone;
  double head_m;
  Vector3 p_free_m, p_rest_m, p_stepped_m;         ///< apex: clear of the bone, pressed, after the step
  std::function<Vector3(const Vector3&)> ideal_N;  ///< force on the tool, as a function of the apex
};

/// Errors of the rendered force, relative to the ideal force.
struct Errors {
  double rest{0.0};     ///< while the tool rests
  double noticed{0.0};  ///< largest, from 10 ms after the step on
  double at_once{0.0};  ///< largest, in the first 10 ms after the step
  double ideal_N{0.0};  ///< magnitude of the ideal force after the step
};

Errors RunCourse(const Course& course) {
  const simulation::Tool tool = MakeBallTool(course.head_m);
  simulation::ReferenceEngine engine(course.bone, tool, Pose::Identity(), {});
  const control::CouplingParams params;
  control::CouplingState state;
  struct Frame {
    int arrives_ms;
    simulation::ContactModel model;
  };
  std::deque<Frame> frames_in_flight;
  simulation::ContactModel newest;
  Errors errors;
  const int step_ms = kApproach_ms + kHold_ms;
  for (int ms = 1; ms < step_ms + kAfter_ms; ++ms) {
    const double s = std::min(1.0, static_cast<double>(ms) / kApproach_ms);
    const Vector3 p = ms < step_ms ? Vector3(course.p_free_m + s * (course.p_rest_m - course.p_free_m))
                                   : course.p_stepped_m;
    const Pose X_WT = Downwards(p);
    const rt::Nanoseconds now = ms * rt::kMillisecond;
    if (ms % kFrameEvery_ms == 0) {
      simulation::FrameInput input = FrameAt(X_WT, 0.0, 1e-3 * kFrameEvery_ms);
      input.stamp = now;
      frames_in_flight.push_back({.arrives_ms = ms + kFrameTakes_ms, .model = engine.Step(input)});
    }
    while (!frames_in_flight.empty() && frames_in_flight.front().arrives_ms <= ms) {
      newest = frames_in_flight.front().model;
      frames_in_flight.pop_front();
    }
    const control::CouplingOutput out =
        control::EvaluateCoupling(params, {.model = newest, .X_WT = X_WT, .now = now}, state);
    const Vector3 ideal_N = course.ideal_N(p);
    const double error = (out.F_T_W.f - ideal_N).norm() / std::max(1.0, ideal_N.norm());
    if (ms == step_ms - 1) errors.rest = error;
    if (ms >= step_ms && ms < step_ms + kNoticed_ms) errors.at_once = std::max(errors.at_once, error);
    if (ms >= step_ms + kNoticed_ms) errors.noticed = std::max(errors.noticed, error);
    errors.ideal_N = ideal_N.norm();
  }
  std::printf("%.0f N: %.3f %% at rest, %.2f %% within 10 ms of the step, %.3f %% after\n", errors.ideal_N,
              100.0 * errors.rest, 100.0 * errors.at_once, 100.0 * errors.noticed);
  return errors;
}

/// At most 1 % of error at rest, and 7 % from 10 ms after the step on.
void ExpectRenderedForceIsTrue(const Course& course) {
  const Errors errors = RunCourse(course);
  EXPECT_GT(errors.ideal_N, 20.0);
  EXPECT_LT(errors.rest, 0.01);
  EXPECT_LT(errors.noticed, 0.07);
}

simulation::Bone Block(const Vector3& low_m, const Vector3& high_m) {
  return WithFriction(MakeBlock({.low_m = low_m, .high_m = high_m}), 0.0);
}

TEST(RenderedForce, OnAWallEqualsTheIdealWalls) {
  ExpectRenderedForceIsTrue(
      {.bone = Block({-8e-3, -8e-3, -4e-3}, {8e-3, 8e-3, 0}),
       .head_m = 6e-3,
       .p_free_m = {0, 0, 0.5e-3},
       .p_rest_m = {0, 0, -3e-3},
       .p_stepped_m = {1e-3, 0.5e-3, -4.5e-3},
       .ideal_N = [](const Vector3& p) { return Vector3(0, 0, kK * std::max(0.0, -p.z())); }});
}

// The tool presses on the wall and on the floor; the step goes along both and into both.
TEST(RenderedForce, InACornerEqualsTheSumOfBothFaces) {
  constexpr double kWall_m = -4e-3, kHead_m = 6e-3;
  simulation::Bone bone = Block({-6e-3, -8e-3, -2e-3}, {10e-3, 8e-3, 0});
  Append(Block({-6e-3, -8e-3, -2e-3}, {kWall_m, 8e-3, 10e-3}), bone);
  ExpectRenderedForceIsTrue({.bone = bone,
                             .head_m = kHead_m,
                             .p_free_m = {kWall_m + kHead_m + 1e-3, 0, 1e-3},
                             .p_rest_m = {kWall_m + kHead_m - 2e-3, 0, -2e-3},
                             .p_stepped_m = {kWall_m + kHead_m - 3e-3, 1e-3, -3.5e-3},
                             .ideal_N = [=](const Vector3& p) {
                               return Vector3(kK * std::max(0.0, kWall_m + kHead_m - p.x()), 0,
                                              kK * std::max(0.0, -p.z()));
                             }});
}

// A head of 24 mm in a cup of 25: a step of half a millimetre along the cup turns the normal by 6 deg at
// once, and the planes follow with the next frame.
TEST(RenderedForce, InACupEqualsTheIdealSpheres) {
  constexpr double kCup_m = 25e-3, kHead_m = 24e-3;
  simulation::AcetabulumParams cup;
  cup.shape.width_m = 56e-3;
  cup.shape.height_m = 30e-3;
  cup.shape.cup_radius_m = kCup_m;
  cup.points.cells = {.finest_m = 3e-3, .coarser_from_m = {}};  // contact only
  cup.packing.surface_gap_m = 0.1e-3;
  const auto apex = [=](double deg, double depth_m) {
    const double a = deg * M_PI / 180.0;
    const Vector3 out(0.8 * std::sin(a), 0.6 * std::sin(a), -std::cos(a));
    return Vector3((kCup_m - kHead_m + depth_m) * out - (kHead_m * Vector3::UnitZ()));
  };
  ExpectRenderedForceIsTrue({.bone = WithFriction(simulation::MakeAcetabulum(cup), 0.0),
                             .head_m = kHead_m,
                             .p_free_m = apex(30.0, -0.5e-3),
                             .p_rest_m = apex(30.0, 4e-3),
                             .p_stepped_m = apex(36.0, 5e-3),
                             .ideal_N = [=](const Vector3& p) {
                               const Vector3 centre = p + (kHead_m * Vector3::UnitZ());
                               const double depth_m = std::max(0.0, centre.norm() - (kCup_m - kHead_m));
                               return Vector3(-kK * depth_m * centre.normalized());
                             }});
}

}  // namespace
}  // namespace osteon::studies
