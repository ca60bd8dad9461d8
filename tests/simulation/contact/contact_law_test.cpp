#include "simulation/contact/contact_law.h"

#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

// Tests of the contact law in one frame: bins of direction, the tool's position between planes, reported
// contacts.

namespace osteon::simulation {
namespace {

constexpr double kTolerance_m = 0.02e-3;  // contact tolerance: overlap that may remain between facing balls

Vector3 RandomDirection(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vector3(normal(random), normal(random), normal(random)).normalized();
}

// ---- bins of direction

TEST(FindBin, DividesTheSphereIntoBinsOfSimilarSize) {
  std::mt19937 random(1);
  std::array<int, kContactBins> count{};
  for (int i = 0; i < 54'000; ++i) {
    const Vector3 u = RandomDirection(random);
    const ContactBin cutting = FindBin(u, true), shaft = FindBin(u, false);
    ASSERT_GE(cutting.number, 0);
    ASSERT_LT(cutting.number, kCuttingBins);
    ASSERT_GE(shaft.number, kCuttingBins);
    ASSERT_LT(shaft.number, kContactBins);
    ++count[static_cast<std::size_t>(cutting.number)];
    ++count[static_cast<std::size_t>(shaft.number)];
    // a third of a cube's face extends 27 degrees from its centre, a whole face 55
    ASSERT_GE(cutting.off_centre, -1e-12);
    ASSERT_LT(cutting.off_centre, 1.0 - std::cos(27.0 * M_PI / 180.0));
    ASSERT_LT(shaft.off_centre, 1.0 - std::cos(55.0 * M_PI / 180.0));
  }
  for (std::size_t b = 0; b < kCuttingBins; ++b) {
    // A bin gets 1000 directions on average. The bin in the middle of a cube's face covers 1.72 times the
    // mean solid angle, a corner's bin half of it
    EXPECT_GT(count[b], 500) << b;
    EXPECT_LT(count[b], 1950) << b;  // five standard deviations above
  }
}

TEST(FindBin, PutsOppositeDirectionsIntoDifferentBins) {
  std::mt19937 random(2);
  for (int i = 0; i < 1000; ++i) {
    const Vector3 u = RandomDirection(random);
    for (const bool cutting : {true, false})
      ASSERT_NE(FindBin(u, cutting).number, FindBin(-u, cutting).number);
  }
}

TEST(Nearer, PrefersTheLowerScoreAndThenTheSmallerIndices) {
  NearPair a{.pair = {7, 1}, .present = true, .gap_m = 1e-3, .score_m = 1e-3};
  NearPair b = a;
  EXPECT_FALSE(Nearer(a, b));
  b.pair = {6, 9};
  EXPECT_TRUE(Nearer(b, a));
  EXPECT_FALSE(Nearer(a, b));
  b.score_m = 1.1e-3;
  EXPECT_FALSE(Nearer(b, a));
  EXPECT_TRUE(Nearer(a, NearPair{}));
}

// ---- solution for the tool's position

/// A contact problem of one frame, built pair by pair.
struct Scene {
  NearField near;
  ContactInput input;
  CuttingParams params;
  ContactMemory memory;
  int count{0};

  /// Adds a pair: normal n in G, gap at first contact, and the centre in T of a tool ball of radius 5 mm. The
  /// ball moves by the frame's motion as it is set before this call.
  void Add(const Vector3& n, double gap_m, const Vector3& c_T = Vector3::Zero()) {
    const auto i = static_cast<std::uint32_t>(count++);
    near.nearest[i] = {.pair = {i, 0},
                       .present = true,
                       .n = n.normalized(),
                       .gap_m = gap_m,
                       .score_m = gap_m,
                       .motion_m = input.motion_G_m,
                       .center_T_m = c_T,
                       .tool_radius_m = 5e-3};
  }
  ContactSolution Solve(bool turning = true) const {
    return SolveContacts(FindCandidates(near, kTolerance_m), input, turning);
  }
  /// The contacts that the frame reports; also fills the memory for the next frame.
  FrameSolution ReportContacts() {
    FrameSolution solution;
    const Candidates candidates = FindCandidates(near, kTolerance_m);
    FillContacts(params, near, candidates, SolveContacts(candidates, input, true),
                 SolveContacts(candidates, input, false), input, memory, solution);
    return solution;
  }
};

TEST(SolveContacts, PushesBackByTheDepthAlongAPlanesNormal) {
  Scene scene;
  scene.input.motion_G_m = Vector3(1e-3, 0, -3e-3);
  scene.Add(Vector3::UnitZ(), 0.1e-3);
  const ContactSolution held = scene.Solve();
  EXPECT_LT((held.point_m() - Vector3(0, 0, 2.9e-3)).norm(), 2e-8);  // tolerance: the slack of the planes
  EXPECT_NEAR(held.normal_m, 2.9e-3, 2e-8);
  EXPECT_EQ(held.force_multiplier_cap_m, held.normal_m);
}

// Coulomb friction: a slip below mu times the depth is prevented, a larger slip is reduced by that amount.
TEST(SolveContacts, FrictionPreventsSlipInsideTheConeAndReducesSlipOutside) {
  for (const double slip_m : {0.2e-3, 0.5e-3, 0.7e-3, 3e-3}) {
    Scene scene;
    scene.input.motion_G_m = Vector3(slip_m, 0, -2e-3);
    scene.input.friction = 0.3;
    scene.Add(Vector3::UnitZ(), 0.0);
    const double prevented_m = std::min(slip_m, 0.3 * 2e-3);
    EXPECT_NEAR(scene.Solve().point_m().x(), -prevented_m, 1e-8) << slip_m;
    EXPECT_NEAR(scene.Solve().point_m().z(), 2e-3, 1e-7) << slip_m;
  }
}

TEST(SolveContacts, FrictionCountsTheSlipThatARotationCauses) {
  Scene scene;
  scene.input.motion_G_m = Vector3(0, 0, -2e-3);
  scene.input.turn_G = Vector3(0, 0.01, 0);  // about the ball's centre: its underside slips by -50 um
  scene.input.friction = 0.3;
  scene.Add(Vector3::UnitZ(), 0.0);
  EXPECT_NEAR(scene.Solve(true).point_m().x(), 0.05e-3, 1e-8);
  EXPECT_NEAR(scene.Solve(false).point_m().x(), 0.0, 1e-12);
}

TEST(FindCandidates, LetsAToolMoveAlongASlotOfItsOwnWidth) {
  Scene scene;
  scene.input.motion_G_m = Vector3(0, 0.1e-3, 0);
  // the next balls of both walls lean slightly toward the tool: planes tangent to them would stop the tool at
  // once
  scene.Add({1, -0.05, 0}, 0.0);
  scene.Add({-1, -0.05, 0}, 0.0);
  EXPECT_EQ(scene.Solve().point_m(), Vector3::Zero());
  Scene floor = scene;  // a single wall does not yield
  floor.near.nearest[1].present = false;
  EXPECT_GT(floor.Solve().point_m().norm(), 1e-6);
}

// A tool 0.1 mm too wide for its slot is pressed down by 1 mm. The walls' multipliers balance each other and
// are huge, but only the press and the overlap may count as force.
TEST(SolveContacts, AWedgedToolsForceIsLimitedToPressAndOverlap) {
  Scene scene;
  scene.input.motion_G_m = Vector3(0, 0, -1e-3);
  scene.Add(Vector3::UnitX(), -0.1e-3);
  scene.Add(-Vector3::UnitX(), -0.1e-3);
  scene.Add(Vector3::UnitZ(), 0.0);
  const ContactSolution held = scene.Solve();
  EXPECT_GT(held.normal_m, 10.0);  // in metres: the walls' multipliers, before the cap
  // the cap is twice the 1 mm by which the tool is pressed, plus the overlap
  EXPECT_LT(held.force_multiplier_cap_m, 2.2e-3);
  const FrameSolution solution = scene.ReportContacts();
  Vector3 sum = Vector3::Zero();
  double size = 0.0;
  for (int c = 0; c < solution.contact_count; ++c) {
    const SolvedContact& contact = solution.contacts[static_cast<std::size_t>(c)];
    sum += contact.multiplier_m * contact.n;
    size += contact.multiplier_m;
  }
  EXPECT_LT(size, 4.5e-3);
  EXPECT_LT((sum - held.goal.point_m).norm(), 0.05 * held.goal.point_m.norm());
}

// ---- reported contacts

/// Projects the frame's pose onto the reported contacts, as the servo loop does.
HalfSpaceProjection ProjectLikeTheServoLoop(const FrameSolution& solution) {
  std::array<HalfSpace, kMaxHalfSpaces> planes{};
  for (int c = 0; c < solution.contact_count; ++c) {
    const SolvedContact& contact = solution.contacts[static_cast<std::size_t>(c)];
    planes[static_cast<std::size_t>(c)] = {.n = contact.n, .offset = -contact.gap_m};
  }
  return ClosestInHalfSpaces(planes, solution.contact_count);
}

// From the reported contacts the servo loop must compute the same force as the frame's solution.
TEST(FillContacts, GivesTheServoLoopTheFramesForce) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  int several = 0;
  for (int i = 0; i < 200; ++i) {
    Scene scene;
    scene.input.motion_G_m = Vector3(u(random) - 0.5, u(random) - 0.5, -1.0) * 4e-3;
    scene.input.friction = i % 2 == 0 ? 0.0 : 0.3;
    for (int k = 0; k < 30; ++k) {
      Vector3 n = RandomDirection(random);
      n.z() = 0.2 + std::abs(n.z());
      scene.Add(n, 0.2e-3 * u(random), 3e-3 * RandomDirection(random));
    }
    // the sums are weighted by lens volumes, so each face's mean normal differs slightly from the normal of
    // the pair that holds the tool
    static_cast<void>(scene.ReportContacts());
    for (int f = 0; f < scene.memory.face_count; ++f)
      for (int k = 0; k < 30; ++k)
        scene.near.faces[static_cast<std::size_t>(f)].Add(1e-12 * u(random),
                                                          scene.memory.face_n_G[static_cast<std::size_t>(f)],
                                                          scene.near.nearest[static_cast<std::size_t>(k)]);
    const FrameSolution solution = scene.ReportContacts();
    ASSERT_LE(solution.contact_count, kMaxContacts);
    Vector3 force = Vector3::Zero();
    int holding = 0;
    for (int c = 0; c < solution.contact_count; ++c) {
      const SolvedContact& contact = solution.contacts[static_cast<std::size_t>(c)];
      EXPECT_NEAR(contact.n.norm(), 1.0, 1e-12);
      force += contact.multiplier_m * contact.n;
      holding += contact.multiplier_m > 0.0 ? 1 : 0;
    }
    several += holding > 1 ? 1 : 0;
    const HalfSpaceProjection servo = ProjectLikeTheServoLoop(solution);
    EXPECT_LT((servo.point - force).norm(), 1e-7) << i;
    EXPECT_EQ(servo.violation, 0.0) << i;
  }
  EXPECT_GT(several, 20);
}

// A burr's edge and its shaft press against one wall. The edge's plane recedes while it cuts, so the shaft's
// plane must be reported too; otherwise the servo loop lets the shaft sink in as deep as the edge has cut.
TEST(FillContacts, ReportsAShaftBesideAnEdgeThatPressesInTheSameDirection) {
  Scene scene;
  scene.input.motion_G_m = Vector3(0, 0, -0.2e-3);
  scene.Add({0, 0, 1}, 0.0);
  scene.Add({0.1, 0, 1}, 0.05e-3);
  scene.near.nearest[1].cutting = false;
  scene.Add({0, 0.1, 1}, 0.05e-3);  // another cutting ball, on the same face as the edge
  const FrameSolution solution = scene.ReportContacts();
  ASSERT_EQ(solution.contact_count, 2);
  EXPECT_TRUE(solution.contacts[0].cutting);
  EXPECT_FALSE(solution.contacts[1].cutting);
  EXPECT_LT(solution.contacts[1].gap_m, -0.14e-3) << "at the tool's pose it is inside";

  scene.near.nearest[0].cutting = false;
  EXPECT_EQ(scene.ReportContacts().contact_count, 1) << "nothing recedes: one plane of the face is enough";
}

TEST(FillContacts, ContactPointIsTheBallsFootAlongTheContactsNormal) {
  Scene scene;
  scene.input.R_GT = ExpRotation({0.3, -0.2, 0.1});
  scene.input.motion_G_m = Vector3(0, 0, -1e-3);
  scene.Add({0.1, 0, 1}, 0.0, {1e-3, 2e-3, 3e-3});
  const FrameSolution solution = scene.ReportContacts();
  ASSERT_EQ(solution.contact_count, 1);
  const Vector3 n = Vector3(0.1, 0, 1).normalized();
  const Vector3 foot = Vector3(1e-3, 2e-3, 3e-3) - 5e-3 * (scene.input.R_GT.transpose() * n);
  EXPECT_LT((solution.contacts[0].p_T_m - foot).norm(), 1e-12);
}

// The tool moves along -x and -z, so the planes of balls 1 and 2 stop it, and the plane of ball 0 does not.
TEST(FillContacts, RemembersTheHoldingPairsAndTheFacesNormals) {
  Scene scene;
  scene.input.motion_G_m = Vector3(-1e-3, 0, -2e-3);
  scene.Add(Vector3::UnitY(), 0.1e-3);
  scene.Add(Vector3::UnitX(), 0.0);
  scene.Add(Vector3::UnitZ(), 0.0);
  scene.ReportContacts();
  ASSERT_EQ(scene.memory.face_count, 2);
  EXPECT_LT((Vector3(scene.memory.face_n_G[0]) - Vector3::UnitZ()).norm(), 1e-12);  // the stronger first
  EXPECT_LT((Vector3(scene.memory.face_n_G[1]) - Vector3::UnitX()).norm(), 1e-12);
  ASSERT_EQ(scene.memory.pair_count, 3);
  const std::set<std::uint32_t> held{scene.memory.pairs[0].bone_ball, scene.memory.pairs[1].bone_ball};
  EXPECT_EQ(held, (std::set<std::uint32_t>{1, 2}));
}

}  // namespace
}  // namespace osteon::simulation
