#include "simulation/surface/dual_surface.h"

#include <algorithm>
#include <bit>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "base/scramble.h"
#include "simulation/surface/dual_cases.h"
#include "simulation/surface/welded_surface.h"
#include "tests/simulation/surface/surface_shapes.h"

namespace osteon::surface {
namespace {

/// Euler's number V - E + F of a closed mesh of quads, where each edge belongs to two quads: E = 2 F.
long EulerNumber(const WeldedSurface& mesh) {
  return static_cast<long>(mesh.vertices_mm.size()) - static_cast<long>(mesh.quads.size());
}

/// Counts vertices whose quads don't form one closed fan: there the mesh is no manifold.
std::size_t CountBadFans(const WeldedSurface& mesh) {
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> links(mesh.vertices_mm.size());
  for (const auto& q : mesh.quads)
    for (std::size_t i = 0; i < 4; ++i) links[q[i]].emplace_back(q[(i + 1) % 4], q[(i + 3) % 4]);
  return static_cast<std::size_t>(std::count_if(links.begin(), links.end(), [](const auto& fan) {
    std::uint32_t at = fan.front().first;
    std::size_t steps = 0;
    do {
      const auto next =
          std::find_if(fan.begin(), fan.end(), [&](const auto& link) { return link.first == at; });
      if (next == fan.end()) return true;
      at = next->second;
      ++steps;
    } while (at != fan.front().first && steps <= fan.size());
    return steps != fan.size();
  }));
}

/// Pseudo-random value in -1 … 1 of a place; neighbouring places are unrelated.
double Noise(Vec3 p, std::uint64_t seed) {
  std::uint64_t bits = seed;
  for (const float along : {p.x, p.y, p.z})
    bits = simulation::Scramble(bits ^ std::bit_cast<std::uint32_t>(along));
  return 2.0 * simulation::Uniform(bits) - 1.0;
}

/// Expects a closed manifold: no open or over-shared edge, one fan at each vertex, an even Euler number.
void ExpectManifold(const WeldedSurface& mesh) {
  const EdgeCounts edges = CountEdges(mesh);
  EXPECT_EQ(edges.open, 0U);
  EXPECT_EQ(edges.over_shared, 0U);
  EXPECT_EQ(CountBadFans(mesh), 0U);
  EXPECT_EQ(EulerNumber(mesh) % 2, 0);
}

// inside: a bit for each of the 8 corners; flip: a bit for each of the 6 faces (TraceCell)
TEST(DualCases, EveryCutEdgeBelongsToOnePatchOfAtLeastThreeEdges) {
  for (unsigned inside = 0; inside < 256; ++inside)
    for (unsigned flip = 0; flip < 64; ++flip) {
      const CellCase cell = TraceCell(inside, flip);
      ASSERT_LE(cell.patches, kMaxPatches);
      std::array<int, kMaxPatches> edges{};
      for (int edge = 0; edge < kCellEdges; ++edge) {
        const bool cut = (inside >> EdgeCorner(edge, 0) & 1U) != (inside >> EdgeCorner(edge, 1) & 1U);
        const std::uint8_t patch = cell.patch[static_cast<std::size_t>(edge)];
        ASSERT_EQ(cut, patch != kNotCut);
        if (cut) ++edges[patch];
      }
      for (int k = 0; k < cell.patches; ++k) ASSERT_GE(edges[static_cast<std::size_t>(k)], 3);
    }
}

TEST(DualSurface, IsManifoldForRandomNoise) {
  std::mt19937 random(21);
  for (int trial = 0; trial < 4; ++trial) {
    const auto solid = std::make_shared<const SolidField>(
        MakeLayout({0.0F, 0.0F, 0.0F}, {19.0F, 19.0F, 19.0F}, 1.0F), [trial](Vec3 p) {
          const bool in_box = std::min({p.x, p.y, p.z}) >= 0.0F && std::max({p.x, p.y, p.z}) <= 19.0F;
          return in_box ? Noise(p, static_cast<std::uint64_t>(trial)) : 1.0;
        });
    CarvedField field(solid);
    if (trial >= 2) field.Carve(RandomToolPath(random, 19.0F, 3.0F, 30));
    const WeldedSurface mesh = WeldSurface(field);
    EXPECT_GT(mesh.quads.size(), 5000U);
    ExpectManifold(mesh);
  }
}

TEST(DualSurface, IsWatertightWithTheRightVolumeAfterRandomCuts) {
  constexpr float kSolid_mm = 6.0F, kVoxel_mm = 0.25F, kPoints_mm = 0.2F;
  const auto solid = BallField(kSolid_mm, kVoxel_mm);
  const double whole_mm3 = VolumeOf(WeldSurface(CarvedField(solid)));
  EXPECT_NEAR(whole_mm3, 4.0 / 3.0 * std::numbers::pi * 216.0, 2.0);  // facets lie inside the sphere
  std::mt19937 random(22);
  for (int trial = 0; trial < 100; ++trial) {
    const float radius_mm = trial % 2 == 0 ? 20.0F * kVoxel_mm : 4.0F * kVoxel_mm;
    const std::vector<Capsule> way = RandomToolPath(random, 4.0F, radius_mm, trial % 2 == 0 ? 3 : 12);
    CarvedField field(solid);
    field.Carve(way);
    const WeldedSurface mesh = WeldSurface(field);
    SCOPED_TRACE(trial);
    ExpectManifold(mesh);
    if (trial % 10 >= 2) continue;
    // Computes the cleared volume by counting evenly spaced points in the ball.
    double cleared_mm3 = 0.0;
    for (float z = -kSolid_mm; z < kSolid_mm; z += kPoints_mm)
      for (float y = -kSolid_mm; y < kSolid_mm; y += kPoints_mm)
        for (float x = -kSolid_mm; x < kSolid_mm; x += kPoints_mm) {
          const Vec3 p{x, y, z};
          if (Norm(p) < kSolid_mm &&
              std::any_of(way.begin(), way.end(), [&](const Capsule& c) { return DepthIn(c, p) > 0.0F; }))
            cleared_mm3 += static_cast<double>(kPoints_mm * kPoints_mm * kPoints_mm);
        }
    const double share = trial % 2 == 0 ? 0.01 : 0.04;  // tool radius of 20 voxels, 4 voxels
    EXPECT_NEAR(whole_mm3 - VolumeOf(mesh), cleared_mm3, share * cleared_mm3);
  }
}

/// Errors of the cut face of a hemispherical cup, away from its rim.
struct CupErrors {
  double p95_mm{0.0}, mean_mm{0.0}, mean_angle_deg{0.0};
};

/// Reams a vertical cup into a block and compares the cut face with the reamer's sphere.
CupErrors CutCup(float radius_mm, float voxel_mm) {
  CarvedField field(BlockField(radius_mm + 4.0F, radius_mm + 4.0F, voxel_mm));
  const Capsule reamer{{0.1F, 0.2F, 8.0F}, {0.1F, 0.2F, -0.3F}, radius_mm};
  field.Carve({&reamer, 1});
  std::vector<double> errors;
  double angles = 0.0;
  SurfaceChunk chunk;
  for (BrickIndex brick = 0; brick < field.layout().Count(); ++brick) {
    ExtractChunk(field, brick, chunk);
    for (const SurfaceVertex& v : chunk.vertices) {
      if (!v.cut || v.p_mm.z > -1.5F) continue;
      const Vec3 from_centre = v.p_mm - reamer.b_mm;
      errors.push_back(std::abs(static_cast<double>(Norm(from_centre) - radius_mm)));
      const float cosine = -Dot(v.normal, from_centre) / Norm(from_centre);
      angles += std::acos(std::min(1.0, static_cast<double>(cosine)));
    }
  }
  std::sort(errors.begin(), errors.end());
  double sum = 0.0;
  for (const double e : errors) sum += e;
  const auto count = static_cast<double>(errors.size());
  return {.p95_mm = errors[errors.size() * 95 / 100],
          .mean_mm = sum / count,
          .mean_angle_deg = angles / count * 180.0 / std::numbers::pi};
}

TEST(DualSurface, CupFaceLiesOnTheReamersSphereAndConvergesWithSecondOrder) {
  constexpr float kHipReamer_mm = 25.0F;
  const CupErrors coarse = CutCup(kHipReamer_mm, 1.0F), fine = CutCup(kHipReamer_mm, 0.5F);
  EXPECT_LE(fine.p95_mm, 0.005);
  EXPECT_LE(fine.mean_angle_deg, 0.1);
  // second order: half the voxel, a quarter of the error
  EXPECT_GT(coarse.mean_mm / fine.mean_mm, 3.0);
  EXPECT_LT(coarse.mean_mm / fine.mean_mm, 5.0);
}

TEST(DualSurface, DrilledHoleHasASharpRim) {
  CarvedField field(BlockField(8.0F, 8.0F, 0.5F));
  const Capsule drill{{0.13F, 0.21F, 5.0F}, {0.13F, 0.21F, -2.0F}, 3.0F};
  field.Carve({&drill, 1});
  SurfaceChunk chunk;
  std::size_t rim = 0;
  for (BrickIndex brick = 0; brick < field.layout().Count(); ++brick) {
    ExtractChunk(field, brick, chunk);
    for (std::size_t i = 1; i < chunk.vertices.size(); ++i) {
      const SurfaceVertex &a = chunk.vertices[i - 1], &b = chunk.vertices[i];
      if (a.key != b.key) continue;
      ++rim;  // two vertices at one place: one normal of the top face, one of the cylinder
      EXPECT_NEAR(a.p_mm.z, 0.0F, 0.01F);
      EXPECT_NEAR(std::hypot(a.p_mm.x - 0.13F, a.p_mm.y - 0.21F), 3.0F, 0.02F);
      EXPECT_LT(std::abs(Dot(a.normal, b.normal)), 0.05F);
      EXPECT_NE(a.cut, b.cut);
    }
  }
  EXPECT_GT(rim, 30U);
}

TEST(DualSurface, OverlappingBallsGiveTheirUnion) {
  const std::vector<Capsule> balls{{{-2.0F, 0.0F, 0.0F}, {-2.0F, 0.0F, 0.0F}, 4.0F},
                                   {{2.0F, 0.0F, 0.0F}, {2.0F, 0.0F, 0.0F}, 4.0F}};
  const auto solid = std::make_shared<const SolidField>(
      MakeLayout({-6.0F, -4.0F, -4.0F}, {6.0F, 4.0F, 4.0F}, 0.25F), std::span<const Capsule>(balls));
  const WeldedSurface mesh = WeldSurface(CarvedField(solid));
  ExpectManifold(mesh);
  // The overlap of two balls, d = 4 mm apart, is two caps: 2 pi/3 (2 r + d/2) (r - d/2)²
  const double lens_mm3 = 2.0 * std::numbers::pi / 3.0 * (2.0 * 4.0 + 2.0) * 4.0;
  EXPECT_NEAR(VolumeOf(mesh), 2.0 * 4.0 / 3.0 * std::numbers::pi * 64.0 - lens_mm3, 2.0);
}

}  // namespace
}  // namespace osteon::surface
