#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "simulation/contact/cutting_math.h"
#include "simulation/fidelity/carved_shape.h"
#include "simulation/methods/ball_bone.h"
#include "simulation/methods/method.h"
#include "simulation/methods/paper_math.h"
#include "tests/simulation/engine/engine_bench.h"

// Tests of the methods that the engine is compared with. Each method must perform as well as its kind can, so
// that the comparison is fair. The last tests show the known weaknesses of each method.

namespace osteon::simulation {
namespace {

constexpr double kVoxel_m = 0.25e-3;

/// A slab with its upper face at z = 0, for all methods: balls, points and, for voxels, the solid.
struct Plate {
  explicit Plate(double width_m, double thickness_m, double u_c = kSpongy)
      : bone(Slab(width_m, thickness_m, true, u_c)),
        solid({-0.5 * width_m, -0.5 * width_m, -thickness_m}, {0.5 * width_m, 0.5 * width_m, 0.0}) {}

  [[nodiscard]] std::unique_ptr<MethodEngine> Make(Method method, const Tool& tool,
                                                   const CuttingParams& params = {}) const {
    return MakeMethod(method, bone, &solid, tool, Pose::Identity(), params, {.voxel_m = kVoxel_m});
  }

  Bone bone;
  BoxSolid solid;
};

/// Plates 20 mm wide and 6 mm thick, shared by tests, since making the mass points takes longer than a test.
const Plate& SpongyPlate() {
  static const Plate plate(0.02, 0.006);
  return plate;
}
const Plate& SoftPlate() {
  static const Plate plate(0.02, 0.006, kSoft);
  return plate;
}

/// The method's name without its hyphens, as a part of a test's name.
std::string NameOf(const testing::TestParamInfo<Method>& method) {
  std::string name(MethodName(method.param));
  std::erase(name, '-');
  return name;
}

/// Tests of this suite run for every method.
class Methods : public testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(, Methods, testing::ValuesIn(kMethods), NameOf);

/// Lowers the tool's apex along the z axis in steps of 0.05 mm and returns the last frame.
ContactModel LowerTo(CuttingEngine& engine, double from_z_m, double to_z_m, double spindle_rad_per_s = 0.0) {
  ContactModel model;
  const int steps = static_cast<int>(std::ceil((from_z_m - to_z_m) / 0.05e-3 - 1e-9));
  for (int i = 0; i <= steps; ++i)
    model = engine.Step(At(Down({0, 0, from_z_m + (to_z_m - from_z_m) * i / steps}), spindle_rad_per_s));
  return model;
}

TEST_P(Methods, ResistAFlatFaceWithTheCouplingsForce) {
  const Plate& plate = SpongyPlate();
  const auto engine = plate.Make(GetParam(), BallTool(0.004));
  constexpr double kDepth_m = 0.5e-3;
  const ContactModel model = LowerTo(*engine, 0.5e-3, -kDepth_m);
  // The force is K times the depth, upwards. The method's contact plane may be below the face by half a voxel
  // or by the packing's roughness of 0.02 mm. The pointshell's penalty force is smaller: the tool sinks in by
  // 1/20 of the depth if ten points touch, and by a third if one point touches.
  const double expected_N = 20e3 * kDepth_m, surface_N = 20e3 * 0.5 * kVoxel_m;
  const double least =
      GetParam() == Method::kPointshell ? (expected_N - surface_N) / 1.35 : expected_N - surface_N;
  EXPECT_GE(model.F_T_W.f.z, least - 0.6);
  EXPECT_LE(model.F_T_W.f.z, expected_N + 0.2);
  // straight up, to the accuracy of a packing's rows of balls or a staircase of voxels
  EXPECT_LT(std::hypot(model.F_T_W.f.x, model.F_T_W.f.y), 0.05 * model.F_T_W.f.z);
  EXPECT_LT(Vector3(model.F_T_W.t).norm(), 0.05 * model.F_T_W.f.z * 0.004);
}

TEST_P(Methods, ReleaseTheToolWhenItLeavesTheBone) {
  const Plate& plate = SpongyPlate();
  const auto engine = plate.Make(GetParam(), BallTool(0.004));
  LowerTo(*engine, 0.5e-3, -0.5e-3);
  const ContactModel model = engine->Step(At(Down({0, 0, 1e-3})));
  EXPECT_EQ(Vector3(model.F_T_W.f).norm(), 0.0);
  EXPECT_EQ(Pose(model.X_WP).translation().z(), 1e-3);
}

TEST_P(Methods, RemoveAPlungesVolume) {
  const Plate& plate = SpongyPlate();
  const auto engine = plate.Make(GetParam(), BallTool(0.004), {.law = RemovalLaw::kImmediate});
  constexpr double kDepth_m = 2e-3, kR_m = 4e-3;
  const ContactModel model = LowerTo(*engine, 0.5e-3, -kDepth_m, kSpindle_rad_per_s);
  const double cap_m3 = M_PI * kDepth_m * kDepth_m * (kR_m - kDepth_m / 3.0);
  // Methods with balls count mass points 0.5 mm apart, the others voxels of 0.25 mm. Half a voxel is 6 % of
  // the cap's height of 2 mm.
  EXPECT_NEAR(model.removed_volume_m3, cap_m3, 0.06 * cap_m3);
  EXPECT_NEAR(model.removed_mass_kg, 500.0 * model.removed_volume_m3, 1e-12);
  EXPECT_NEAR(model.cutting_work_J, kSpongy * model.removed_volume_m3, 1e-9);
}

TEST_P(Methods, LeaveAHoleWhereTheyCut) {
  const Plate& plate = SpongyPlate();
  const auto engine = plate.Make(GetParam(), BallTool(0.004), {.law = RemovalLaw::kImmediate});
  const auto before = engine->Shape();
  EXPECT_EQ(before->Distance({0, 0, -1.1e-3}, 1e-3), 0.0);
  // the hollows between the lattice's balls are 0.08 mm deep
  EXPECT_NEAR(before->Distance({0, 0, 0.8e-3}, 5e-3), 0.8e-3, 0.09e-3);
  EXPECT_EQ(before->Distance({0, 0, 8e-3}, 1e-3), 1e-3);  // farther than the limit
  LowerTo(*engine, 0.5e-3, -2e-3, kSpindle_rad_per_s);
  // The hole's deepest point is 1.1 mm below this point. A cut removes up to 0.75 mm more from a lattice
  // ball, and half a voxel's diagonal more from voxels.
  EXPECT_NEAR(engine->Shape()->Distance({0, 0, -0.9e-3}, 5e-3), 1.1e-3, 0.5e-3);
  EXPECT_EQ(before->Distance({0, 0, -1.1e-3}, 1e-3), 0.0);  // a shape is a copy: the cut does not change it
}

std::vector<Method> AllButThePrintedPaper() {
  std::vector<Method> methods;
  std::ranges::copy_if(kMethods, std::back_inserter(methods),
                       [](Method method) { return method != Method::kPaperPrinted; });
  return methods;
}

// All methods that have a rate of removal. The paper's method as printed has none.
class MethodsWithRemovalRate : public Methods {};
INSTANTIATE_TEST_SUITE_P(, MethodsWithRemovalRate, testing::ValuesIn(AllButThePrintedPaper()), NameOf);

TEST_P(MethodsWithRemovalRate, CutAtTheRateOfTheEnergyBalance) {
  const Plate& plate = SoftPlate();
  const auto engine = plate.Make(GetParam(), BallTool(0.004));
  LowerTo(*engine, 0.5e-3, 0.0);
  double edge_J = 0.0, work_J = 0.0;
  ContactModel model;
  for (int i = 0; i < 400; ++i) {
    model = engine->Step(At(Down({0, 0, -1.5e-3}), kSpindle_rad_per_s));
    edge_J += model.spindle_torque_Nm * kSpindle_rad_per_s * 1e-3;
    work_J = model.cutting_work_J;
  }
  EXPECT_GT(work_J, 0.01);
  // Points and voxels are removed as a whole, so at first the energy of the removed bone exceeds the
  // spindle's work. The difference is made up over 0.1 s of cutting, a quarter of this run. A step of the
  // pointshell's advance frees only its deepest voxel, so its recovery takes longer.
  EXPECT_NEAR(work_J, edge_J, (GetParam() == Method::kPointshell ? 0.5 : 0.25) * edge_J);
}

// A frame of 50 ms, in which the pressing force falls a lot: the torque must be the mean over the frame.
TEST_P(MethodsWithRemovalRate, SpindleTorqueIsTheMeanOverALongFrame) {
  const Plate& plate = SoftPlate();
  const auto engine = plate.Make(GetParam(), BallTool(0.004));
  const ContactModel pressed = LowerTo(*engine, 0.5e-3, -0.2e-3);
  const double dt_s = 0.05, depth_m = Vector3(pressed.F_T_W.f).norm() / 20e3;
  const ContactModel model =
      engine->Step({.X_WT = Down({0, 0, -0.2e-3}), .spindle_rad_per_s = kSpindle_rad_per_s, .dt_s = dt_s});
  // the tool advances by a large part of the depth, so the force is much smaller at the frame's end
  EXPECT_GT(model.advance_m_per_s * dt_s, 0.3 * depth_m);
  // the spindle's work equals that of the edge's travel, to rounding
  const double work_J = kSoft * model.engaged_area_m2 * model.advance_m_per_s * dt_s;
  EXPECT_NEAR(model.spindle_torque_Nm * kSpindle_rad_per_s * dt_s, work_J, 1e-9 * work_J);
}

TEST_P(Methods, CutNothingWithoutTheSpindle) {
  const Plate& plate = SpongyPlate();
  const auto engine = plate.Make(GetParam(), BallTool(0.004), {.law = RemovalLaw::kImmediate});
  const std::uint64_t before = HashState(engine->Snapshot());
  const ContactModel model = LowerTo(*engine, 0.5e-3, -2e-3);
  EXPECT_EQ(model.removed_volume_m3, 0.0);
  EXPECT_EQ(HashState(engine->Snapshot()), before);
}

TEST_P(Methods, RefuseAnInvalidPoseAndContinue) {
  const Plate& plate = SpongyPlate();
  const auto engine = plate.Make(GetParam(), BallTool(0.004));
  const ContactModel before = LowerTo(*engine, 0.5e-3, -0.2e-3);
  FrameInput bad = At(Down({0, 0, -0.2e-3}), kSpindle_rad_per_s);
  bad.X_WT.p.z = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(engine->Step(bad).status, EngineStatus::kBadInput);
  const ContactModel after = engine->Step(At(Down({0, 0, -0.2e-3})));
  EXPECT_EQ(after.status, EngineStatus::kOk);
  EXPECT_EQ(after.frame, before.frame + 1);
  EXPECT_NEAR(after.F_T_W.f.z, before.F_T_W.f.z, 0.2);
}

TEST_P(Methods, GiveEqualBitsForEqualFrames) {
  const Plate& plate = SoftPlate();
  const auto run = [&] {
    const auto engine = plate.Make(GetParam(), BallTool(0.004));
    ContactModel model;
    for (int i = 0; i < 80; ++i)
      model = engine->Step(At(Down({1e-3 * std::sin(0.1 * i), 0, -0.02e-3 * i}), kSpindle_rad_per_s));
    return std::pair(HashState(engine->Snapshot()), Vector3(model.F_T_W.f));
  };
  const auto [hash, force] = run();
  EXPECT_EQ(run(), std::pair(hash, force));
  EXPECT_GT(force.norm(), 0.1);
}

TEST_P(Methods, RestoreASnapshotAndCutTheSameAgain) {
  const Plate& plate = SpongyPlate();
  const auto engine = plate.Make(GetParam(), BallTool(0.004), {.law = RemovalLaw::kImmediate});
  LowerTo(*engine, 0.5e-3, -1e-3, kSpindle_rad_per_s);
  const CarvedState state = engine->Snapshot();
  const double gap_m = engine->Shape()->Distance({0, 0, 0}, 5e-3);
  const ContactModel deeper = LowerTo(*engine, -1e-3, -2e-3, kSpindle_rad_per_s);
  EXPECT_NE(HashState(engine->Snapshot()), HashState(state));
  engine->Restore(state);
  EXPECT_EQ(HashState(engine->Snapshot()), HashState(state));
  EXPECT_NEAR(engine->Shape()->Distance({0, 0, 0}, 5e-3), gap_m, 1e-9);
  const ContactModel again = LowerTo(*engine, -1e-3, -2e-3, kSpindle_rad_per_s);
  EXPECT_NEAR(again.removed_volume_m3, deeper.removed_volume_m3, 1e-3 * deeper.removed_volume_m3);
  CarvedState other = state;
  other.cleared.pop_back();
  EXPECT_THROW(engine->Restore(other), std::invalid_argument);
}

TEST_P(Methods, RefuseToolsWithoutCuttingBallsAndTooSmallVoxels) {
  const Plate& plate = SpongyPlate();
  Tool blunt = BallTool(0.004);
  blunt.balls[0].cutting = false;
  EXPECT_THROW(static_cast<void>(plate.Make(GetParam(), blunt)), std::invalid_argument);
  if (GetParam() != Method::kPointshell && GetParam() != Method::kVoxelProxy) return;
  try {
    static_cast<void>(MakeMethod(GetParam(), plate.bone, &plate.solid, BallTool(0.004), Pose::Identity(), {},
                                 {.voxel_m = 1e-6}));
    FAIL() << "a voxel of 1 um was accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("found 0.001 mm, accepted 0.01"), std::string::npos)
        << error.what();
  }
}

// ---- weaknesses of single methods

TEST(PaperPrinted, LensVolumeIsNegativeForALargeBoneBall) {
  // In metres, a bone ball that contains the tool ball or is much larger has a negative weight, which flips
  // the normal. The corrected equation is never negative.
  for (const double d : {1e-3, 2e-3, 3e-3}) {
    EXPECT_LT(printed::LensVolume(1e-3, 4e-3, d), 0.0);
    EXPECT_GT(LensVolume(1e-3, 4e-3, d), 0.0);
  }
  // the printed equation depends on the unit: in millimetres the same pair has a positive weight
  EXPECT_LT(printed::LensVolume(1e-3, 4e-3, 2e-3) * printed::LensVolume(1.0, 4.0, 2.0), 0.0);
}

TEST(PaperPrinted, IgnoresPairsThatOverlapAlready) {
  // motion straight inwards with 0.1 mm of overlap: the paper finds no contact, the corrected equation
  // contact at once
  const Vector3 dc(0, 0, -2.9e-3), m(0, 0, -1e-3);
  EXPECT_LT(printed::ContactFraction(dc, m, 3e-3), 0.0);
  EXPECT_EQ(FirstContactFraction(dc, m, 3e-3), 0.0);
  // both agree on balls that are apart
  EXPECT_NEAR(printed::ContactFraction(Vector3(0, 0, -3.5e-3), m, 3e-3), 0.5, 1e-9);
}

TEST(PaperPrinted, RemovesLessFromBallsNearerTheToolsAxis) {
  // equation 5 ignores the tool's radius, so a ball on the tool's axis stays whole
  Vector3 c(0.1, 0, 0);
  double r = 1.0;
  printed::Shrink(c, r, Vector3(-0.1, 0, 0));
  EXPECT_NEAR(r, 0.95, 1e-12);
  EXPECT_NEAR(c.x(), 0.6, 1e-12);  // shrunk by only 0.05, yet moved by 0.5
  printed::Shrink(c, r, Vector3::Zero());
  EXPECT_NEAR(r, 0.95, 1e-12);
  // the corrected equation removes the ball
  Vector3 corrected(0.1, 0, 0);
  double left = 1.0;
  EXPECT_TRUE(ShrinkBall(corrected, left, Vector3(0, 0, -5), Vector3(0, 0, 5), 4.0));
  EXPECT_EQ(left, 0.0);
}

// The printed equation 5 moves a ball of 1 mm partly out of its original ball. A search must still find it
// there, also in a bone that loads this state.
TEST(PaperPrinted, BallThatLeavesItsOriginalBallIsFound) {
  Bone bone = EmptyBone();
  for (int i = 0; i < 20; ++i) bone.balls.push_back({.center_m = Vector3(-3e-3 * i, 0, 0), .radius_m = 1e-3});
  BallBone moved(bone, nullptr);
  moved.Replace(0, Vector3(0.5e-3, 0, 0), 0.95e-3);
  CarvedState state;
  moved.Save(state);
  BallBone loaded(bone, nullptr);
  loaded.Load(state);
  const Vector3 rim(1.4e-3, 0, 0);
  for (const BallBone* where : {&moved, &loaded}) {
    std::vector<std::uint32_t> found;
    where->ForEachBallNear(rim, rim, 0.1e-3,
                           [&](std::uint32_t i, const BallBone::LiveBall&) { found.push_back(i); });
    EXPECT_NE(std::ranges::find(found, 0u), found.end());
  }
}

TEST(PaperPrinted, LosesContactOnceTheToolOverlapsTheBone) {
  Bone boulder = EmptyBone();
  boulder.balls = {{.center_m = Vector3(0, 0, -3e-3), .radius_m = 3e-3}};
  for (const Method method : {Method::kPaperPrinted, Method::kPaperCorrected}) {
    const auto engine = MakeMethod(method, boulder, nullptr, BallTool(0.002), Pose::Identity(), {}, {});
    engine->Step(At(Down({0, 0, -0.05e-3})));  // the first pose counts as free, although it overlaps
    const ContactModel model = engine->Step(At(Down({0, 0, -1.05e-3})));
    if (method == Method::kPaperPrinted)
      EXPECT_EQ(model.F_T_W.f.z, 0.0);
    else
      EXPECT_NEAR(model.F_T_W.f.z, 20.0, 1e-9);  // stiffness times the millimetre of motion
  }
}

TEST(PaperCorrected, ContactSphereAloneLeavesBoneInTheToolsPath) {
  const Plate& plate = SpongyPlate();
  Tool pair = BallTool(0.003);
  pair.balls.push_back({.center_m = Vector3(5e-3, 0, -2.9e-3), .radius_m = 0.003, .cutting = true});
  const auto cut = [&](Cutters cutters) {
    const auto engine =
        plate.Make(Method::kPaperCorrected, pair, {.law = RemovalLaw::kImmediate, .cutters = cutters});
    return LowerTo(*engine, 0.5e-3, -1.5e-3, kSpindle_rad_per_s).removed_volume_m3;
  };
  EXPECT_LT(cut(Cutters::kContactSphere), 0.9 * cut(Cutters::kAll));
}

TEST(Pointshell, TunnelsThroughAThinSheetThatStopsProxyMethods) {
  const Plate sheet(0.02,
                    1.5e-3);  // the thinnest sheet that lattice balls fill; the tool moves 2.5 mm a frame
  for (const Method method : {Method::kPointshell, Method::kVoxelProxy, Method::kPaperCorrected}) {
    const auto engine = sheet.Make(method, BallTool(0.5e-3));
    ContactModel model;
    for (int i = 0; i < 12; ++i) model = engine->Step(At(Down({0, 0, 3.6e-3 - 2.5e-3 * i})));
    const double z = Pose(model.X_WP).translation().z();
    if (method == Method::kPointshell)
      EXPECT_LT(z, -1.5e-3);
    else
      EXPECT_GT(z, -0.3e-3) << MethodName(method);
  }
}

// Kind "stamps" removes bone at each frame's pose only, 3 mm apart for this tool of radius 1 mm.
TEST(Stamps, LeaveRidgesBetweenPosesThatASweepRemoves) {
  const Plate& plate = SpongyPlate();
  const Tool ball = BallTool(1e-3);
  // distance to the nearest bone from a point halfway between two poses, below the face
  const auto distance_between_poses = [&](Method method) {
    const auto engine = plate.Make(method, ball, {.law = RemovalLaw::kImmediate});
    engine->Step(At(Down({-6e-3, 0, 2e-3}), kSpindle_rad_per_s));
    for (double x = -6e-3; x <= 6e-3; x += 3e-3) engine->Step(At(Down({x, 0, -1e-3}), kSpindle_rad_per_s));
    return engine->Shape()->Distance({1.5e-3, 0, -0.3e-3}, 1e-3);
  };
  EXPECT_EQ(distance_between_poses(Method::kStamps), 0.0);
  EXPECT_GT(distance_between_poses(Method::kPaperCorrected), 0.2e-3);
}

TEST(VoxelProxy, SlidesAlongAFace) {
  const Plate& plate = SpongyPlate();
  const auto engine = plate.Make(Method::kVoxelProxy, BallTool(0.002));
  LowerTo(*engine, 0.5e-3, -0.3e-3);
  ContactModel model;
  for (int i = 1; i <= 50; ++i) model = engine->Step(At(Down({0.05e-3 * i, 0, -0.3e-3})));
  const Vector3 p = Pose(model.X_WP).translation();
  EXPECT_NEAR(p.x(), 2.5e-3, 0.2e-3);  // within a voxel of the hand's position
  EXPECT_GT(p.z(), -0.15e-3);
}

}  // namespace
}  // namespace osteon::simulation
