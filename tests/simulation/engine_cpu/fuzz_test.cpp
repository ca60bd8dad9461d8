#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <random>
#include <string>

#include "tests/simulation/engine_cpu/equal_engines.h"

// Compares the CPU engine with the reference engine bit for bit in random small scenes with random motions.
// Each scene has twenty bone balls, three tool balls and sixty mass points within about 0.3 m of the bone's
// origin.
// `osteon_test_cpu_engine --cases=100000 --gtest_filter='*Fuzz*'` runs more scenes; `--first=N` begins at
// seed N.

namespace osteon::simulation {
namespace {

// The number after `key` on the command line, or the default.
int NumberFromCommandLine(const std::string& key, int default_value) {
  for (const std::string& argument : testing::internal::GetArgvs())
    if (argument.rfind(key, 0) == 0) return std::atoi(argument.c_str() + key.size());
  return default_value;
}

// Seeded random numbers.
class Chance {
 public:
  explicit Chance(unsigned seed) : random_(seed) {}
  double In(double low, double high) { return std::uniform_real_distribution<>(low, high)(random_); }
  // True with a probability of 1 / n.
  bool OneIn(int n) { return std::uniform_int_distribution<>(1, n)(random_) == 1; }
  int UpTo(int max) { return std::uniform_int_distribution<>(0, max)(random_); }
  Vector3 Direction() {
    std::normal_distribution<> normal;
    Vector3 v(normal(random_), normal(random_), normal(random_));
    return v.normalized();
  }
  // A point in a cube about the origin.
  Vector3 InCube(double size) { return {In(-size, size), In(-size, size), In(-size, size)}; }

 private:
  std::mt19937 random_;
};

// A random scene of about the size size_m around the point middle_G.
struct Scene {
  Bone bone;
  Tool tool;
  CuttingParams params;
  Pose X_WG{Pose::Identity()};
  Vector3 middle_G{Vector3::Zero()};
  double size_m{2e-3};
};

// Draws a scene: sizes from 0.5 to 10 mm, each option of the parameters with some probability.
Scene MakeScene(Chance& chance) {
  Scene scene;
  scene.size_m = std::pow(10.0, chance.In(-3.3, -2.0));
  if (!chance.OneIn(3)) scene.middle_G = chance.InCube(0.3);
  const int materials = 1 + chance.UpTo(2);
  for (int m = 0; m < materials; ++m)
    scene.bone.materials.push_back({.name = "m" + std::to_string(m),
                                    .density_kg_per_m3 = 500.0,
                                    .specific_cutting_energy_J_per_m3 = std::pow(10.0, chance.In(4.0, 8.0)),
                                    .cutting_force_ratio = 0.8,
                                    .friction = chance.In(0.0, 0.5)});
  for (int i = 0; i < 20; ++i)
    scene.bone.balls.push_back({.center_m = scene.middle_G + chance.InCube(scene.size_m),
                                .radius_m = scene.size_m * chance.In(0.05, 0.8)});
  if (chance.OneIn(4)) scene.bone.balls[1] = scene.bone.balls[0];  // equal balls: ties
  for (int i = 0; i < 60; ++i)
    scene.bone.points.push_back({.p_m = scene.middle_G + chance.InCube(scene.size_m),
                                 .volume_m3 = 1e-9,
                                 .material = static_cast<MaterialIndex>(chance.UpTo(materials - 1))});
  for (int t = 0; t < 3; ++t)
    scene.tool.balls.push_back({.center_m = chance.InCube(scene.size_m),
                                .radius_m = scene.size_m * chance.In(0.05, 1.5),
                                .cutting = !chance.OneIn(3)});
  if (chance.OneIn(4)) scene.tool.balls[2] = scene.tool.balls[1];
  if (chance.OneIn(2)) {
    scene.X_WG.linear() = ExpRotation(3.0 * chance.Direction());
    scene.X_WG.translation() = chance.InCube(1.0);
  }
  CuttingParams& params = scene.params;
  if (chance.OneIn(3)) params.law = RemovalLaw::kImmediate;
  if (chance.OneIn(4)) params.cutters = Cutters::kContactSphere;
  if (chance.OneIn(3)) params.max_slide_m = std::pow(10.0, chance.In(-5.0, -2.3));
  if (chance.OneIn(4)) params.normal_enlargement_m = std::pow(10.0, chance.In(-4.5, -2.5));
  if (chance.OneIn(4)) params.engaged_layer_m = std::pow(10.0, chance.In(-4.5, -2.5));
  if (chance.OneIn(4)) params.contact_tolerance_m = chance.OneIn(2) ? 0.0 : 0.1e-3;
  if (chance.OneIn(3))
    params.split = {.on = true,
                    .min_radius_m = scene.size_m * chance.In(0.05, 0.5),
                    .children = 8 + chance.UpTo(22),
                    .pool_blocks = static_cast<std::size_t>(1 + chance.UpTo(20)),
                    .blocks_per_frame = static_cast<std::size_t>(chance.UpTo(3))};
  return scene;
}

// Moves the tool at random: it may rest, creep, turn or jump. @returns the frame's input
FrameInput NextInput(Chance& chance, const Scene& scene, Pose& X_GT) {
  const double step = scene.size_m * std::pow(10.0, chance.In(-4.0, 0.5));
  if (!chance.OneIn(5)) X_GT.translation() += step * chance.Direction();
  if (chance.OneIn(2)) X_GT.linear() = ExpRotation(chance.In(0.0, 0.02) * chance.Direction()) * X_GT.linear();
  if (chance.OneIn(12)) X_GT.linear() = ExpRotation(chance.In(0.0, 3.0) * chance.Direction());
  // pull the tool back towards the bone, so that it does not wander off
  X_GT.translation() += chance.In(0.0, 0.3) * (scene.middle_G - X_GT.translation());
  return {.X_WT = scene.X_WG * X_GT,
          .spindle_rad_per_s = chance.OneIn(4) ? 0.0 : chance.In(1.0, 3000.0),
          .dt_s = chance.OneIn(10) ? 0.0 : chance.In(1e-4, 1e-2)};
}

// Runs the scene of one seed with one instruction set. @returns the first frame whose bits differ; -1: none
int FirstDifference(unsigned seed, const std::string& set, RunFacts& facts) {
  Chance chance(seed);
  const Scene scene = MakeScene(chance);
  EqualEngines engines(scene.bone, scene.tool, scene.params, scene.X_WG, {set});
  Pose X_GT = Pose::Identity();
  X_GT.linear() = ExpRotation(3.0 * chance.Direction());
  X_GT.translation() = scene.middle_G + 3.0 * scene.size_m * chance.Direction();
  constexpr int kFrames = 12;
  for (int i = 0; i < kFrames; ++i) {
    if (!engines.Step(NextInput(chance, scene, X_GT))) return i;
    if (chance.OneIn(20)) engines.RestoreAll();
  }
  if (!engines.SameStates()) return kFrames;
  facts.touching += engines.facts().touching;
  facts.balls_cut += engines.facts().balls_cut;
  facts.points_cleared += engines.facts().points_cleared;
  facts.split += engines.facts().split;
  return -1;
}

TEST(CpuEngineFuzz, RandomSmallScenesEqualTheReferenceBitForBit) {
  const int cases = NumberFromCommandLine("--cases=", 1'500);
  const std::vector<std::string> sets = CpuInstructionSets();
  RunFacts facts;
  int different = 0;
  const int first = NumberFromCommandLine("--first=", 0);
  for (int i = first; i < first + cases && different < 5; ++i) {
    const auto seed = static_cast<unsigned>(i);
    const std::string& set = sets[static_cast<std::size_t>(i) % sets.size()];
    int frame = -1;
    try {
      frame = FirstDifference(seed, set, facts);
    } catch (const std::exception& error) {
      ADD_FAILURE() << "seed " << seed << ", " << set << ": " << error.what();
      ++different;
    }
    if (frame < 0) continue;
    ++different;
    ADD_FAILURE() << "seed " << seed << ", " << set << ", frame " << frame;
  }
  std::printf("%d cases: %d frames in contact, %zu balls cut, %zu split, %zu points cleared\n", cases,
              facts.touching, facts.balls_cut, facts.split, facts.points_cleared);
  EXPECT_GT(facts.touching, cases);
  EXPECT_GT(facts.balls_cut, static_cast<std::size_t>(cases));
  EXPECT_GT(facts.points_cleared, static_cast<std::size_t>(cases));
}

}  // namespace
}  // namespace osteon::simulation
