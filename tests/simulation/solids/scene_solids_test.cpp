#include <numbers>
#include <random>

#include <gmock/gmock.h>

#include "simulation/solids/box_solid.h"
#include "simulation/solids/femoral_head_solid.h"
#include "simulation/solids/femur_solid.h"
#include "simulation/solids/molar_solid.h"
#include "tests/simulation/mesh/mesh_oracle.h"

// The solids of the generated scenes: distances against brute force, tissues against closed forms.

namespace osteon::simulation {
namespace {

using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

/// Random points in a box that is enlarged on each side by `spare` of its size; the same in every run.
std::vector<Vector3> PointsAround(const Eigen::AlignedBox3d& box, int count, double spare) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> share(-spare, 1.0 + spare);
  std::vector<Vector3> points;
  for (int i = 0; i < count; ++i) {
    const double x = share(random), y = share(random), z = share(random);
    points.emplace_back(box.min() + box.sizes().cwiseProduct(Vector3(x, y, z)));
  }
  return points;
}

/// Expects that the distance changes by no more than the step between two points, and that each nearest point
/// lies on the surface at the stated distance.
void ExpectLipschitzDistanceAndNearestPointsOnSurface(const Solid& solid) {
  const std::vector<Vector3> points = PointsAround(solid.Bounds(), 1500, 0.3);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const SurfacePoint a = solid.NearestSurface(points[i]);
    const double b = solid.SignedDistance(points[i + 1]);
    ASSERT_LE(std::abs(a.distance_m - b), (points[i + 1] - points[i]).norm() + 1e-9) << i;
    ASSERT_NEAR((a.p_m - points[i]).norm(), std::abs(a.distance_m), 1e-9) << i;
    ASSERT_LT(std::abs(solid.SignedDistance(a.p_m)), 1e-6) << i;
  }
}

/// Volume in m³ of each material, by its index: counts the cubic cells whose centre has the material.
std::array<double, 8> Volumes(const Solid& solid, double cell_m) {
  std::array<double, 8> volumes{};
  const Eigen::AlignedBox3d box = solid.Bounds();
  const Vector3 low = box.min();
  for (double z = low.z() + 0.5 * cell_m; z < box.max().z(); z += cell_m)
    for (double y = low.y() + 0.5 * cell_m; y < box.max().y(); y += cell_m)
      for (double x = low.x() + 0.5 * cell_m; x < box.max().x(); x += cell_m)
        if (const Vector3 p(x, y, z); solid.SignedDistance(p) < 0.0)
          volumes.at(solid.MaterialAt(p)) += cell_m * cell_m * cell_m;
  return volumes;
}

/// Returns the message with which CheckShape refuses `shape`, or "accepted".
template <typename Shape>
std::string Refusal(const Shape& shape) {
  try {
    CheckShape(shape);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

// ---------------------------------------------------------------- block

/// From the top: 1.5 mm of material 2, 4 mm of material 1, and a core of material 0.
const BlockShape kLayeredBlock{
    .width_m = 0.020,
    .depth_m = 0.030,
    .height_m = 0.012,
    .layers = {{.material = 2, .thickness_m = 0.0015}, {.material = 1, .thickness_m = 0.0040}},
    .core = 0};

TEST(BlockSolid, DistancesEqualThoseOfABox) {
  const BoxSolid block(kLayeredBlock);
  ExpectLipschitzDistanceAndNearestPointsOnSurface(block);
  const Vector3 half(0.010, 0.015, 0.006), middle(0.0, 0.0, -0.006);
  for (const Vector3& p : PointsAround(block.Bounds(), 500, 0.4)) {
    // Quilez' closed form of a box's distance, relative to the middle
    const Vector3 q = (p - middle).cwiseAbs() - half;
    const double exact = q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
    ASSERT_NEAR(block.SignedDistance(p), exact, 1e-15);
  }
}

TEST(BlockSolid, LayersHaveTheirExactVolumes) {
  const std::array<double, 8> volumes = Volumes(BoxSolid(kLayeredBlock), 0.5e-3);
  const double area = 0.020 * 0.030;
  // the layers' boundaries coincide with cell faces, so that the counted volumes are exact
  EXPECT_NEAR(volumes[2], area * 0.0015, 1e-9 * area);
  EXPECT_NEAR(volumes[1], area * 0.0040, 1e-9 * area);
  EXPECT_NEAR(volumes[0], area * 0.0065, 1e-9 * area);
  const BoxSolid block(kLayeredBlock);
  EXPECT_EQ(block.MaterialAt({0, 0, -0.001499}), 2);
  EXPECT_EQ(block.MaterialAt({0, 0, -0.001501}), 1);
  EXPECT_EQ(block.MaterialAt({0, 0, -0.005501}), 0);
}

TEST(BlockSolid, APlateOneMillimetreThickHasItsDepthAndVolume) {
  const BoxSolid plate(BlockShape{.width_m = 0.030, .depth_m = 0.030, .height_m = 0.001, .layers = {}});
  EXPECT_NEAR(plate.SignedDistance({0, 0, -0.0005}), -0.0005, 1e-15);
  EXPECT_NEAR(Volumes(plate, 0.5e-3)[0], 0.9e-6, 1e-12);
}

TEST(BlockSolid, RefusesSizesThatDoNotFit) {
  BlockShape shape = kLayeredBlock;
  shape.height_m = 0.005;
  EXPECT_EQ(Refusal(shape), "block: layers, in all: found 5.5 mm, accepted 0 … 5 mm");
  shape.height_m = -1.0;
  EXPECT_EQ(Refusal(shape), "block: height: found -1000 mm, accepted 0.1 … 500 mm");
  EXPECT_THROW(BoxSolid(Vector3(0, 0, 0), Vector3(1, 0, 1)), std::invalid_argument);
}

// ---------------------------------------------------------------- molar

class Molar : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    mesh_ = new LoadedMesh(MolarMesh({}));
    solid_ = new MolarSolid(MolarShape{});
  }
  static void TearDownTestSuite() {
    delete mesh_;
    delete solid_;
  }
  /// Height at which a vertical line first meets the surface from above.
  static double Top(double x_m, double y_m) {
    double z = 0.009;
    while (solid_->SignedDistance({x_m, y_m, z}) > 0.0) z -= 2e-6;
    return z;
  }
  static LoadedMesh* mesh_;
  static MolarSolid* solid_;
};
LoadedMesh* Molar::mesh_ = nullptr;
MolarSolid* Molar::solid_ = nullptr;

TEST_F(Molar, HasTheLengthAndWidthsOfALowerMolar) {
  const Eigen::AlignedBox3d box = solid_->Bounds();
  EXPECT_NEAR(box.sizes().z(), 0.0206, 0.1e-3);
  EXPECT_NEAR(box.sizes().x(), 0.0110, 0.6e-3);  // crown, front to back
  EXPECT_NEAR(box.sizes().y(), 0.0100, 0.6e-3);
  const double volume = SignedVolume_m3(mesh_->mesh) * 1e9;
  EXPECT_GT(volume, 600.0);
  EXPECT_LT(volume, 1100.0);
}

TEST_F(Molar, IsOneClosedShellWithAPulpWellInsideIt) {
  LoadedMesh mesh = *mesh_;
  const auto tooth = CheckMesh(mesh.mesh, "tooth");
  ASSERT_TRUE(tooth) << tooth.error().message;
  EXPECT_EQ(tooth->shells.size(), 1u);
  // the narrowest pulp could come apart, the widest could come too near the surface
  LoadedMesh narrow = MolarMesh({.pulp_width = 0.6});
  const auto pulp = CheckMesh(narrow.regions.at(0).mesh, "pulp");
  ASSERT_TRUE(pulp) << pulp.error().message;
  EXPECT_EQ(pulp->shells.size(), 1u) << "chamber, horns and canals hang together";
  const LoadedMesh wide = MolarMesh({.pulp_width = 1.3});
  ASSERT_EQ(wide.regions.size(), 1u);
  const std::vector<Vector3>& vertices = wide.regions[0].mesh.vertices_m;
  double lowest = 1.0, highest = -1.0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    lowest = std::min(lowest, vertices[i].z());
    highest = std::max(highest, vertices[i].z());
    if (i % 3 == 0) {
      ASSERT_LT(solid_->SignedDistance(vertices[i]), -0.45e-3) << vertices[i].transpose();
    }
  }
  EXPECT_LT(lowest, -11.5e-3) << "the canals go down the roots";
  EXPECT_GT(highest, 2.2e-3) << "the horns rise above the chamber's roof";
}

TEST_F(Molar, DistancesEqualThoseToTheMesh) {
  ExpectLipschitzDistanceAndNearestPointsOnSurface(*solid_);
  for (const Vector3& p : PointsAround(solid_->Bounds(), 40, 0.1))
    ASSERT_NEAR(solid_->SignedDistance(p), BruteSignedDistance(mesh_->mesh, p), 1e-9);
}

TEST_F(Molar, EnamelIsThickOnTopAndEndsAtTheNeck) {
  // straight down from the fissures' cross and from the cusps
  for (const Vector3& at : {Vector3(0, 0, 0), Vector3(0.0027, 0.0023, 0), Vector3(-0.0026, -0.0023, 0)}) {
    const double top = Top(at.x(), at.y());
    double z = top - 5e-6;
    while (solid_->MaterialAt({at.x(), at.y(), z}) == MolarSolid::kEnamel) z -= 5e-6;
    EXPECT_EQ(solid_->MaterialAt({at.x(), at.y(), z}), MolarSolid::kDentine);
    // on a slope the vertical distance exceeds the enamel's thickness
    EXPECT_GT(top - z, 1.95e-3);
    EXPECT_LT(top - z, 2.6e-3);
  }
  EXPECT_NEAR(solid_->EnamelThickness(0.008), 0.002, 1e-12);
  EXPECT_NEAR(solid_->EnamelThickness(0.1e-3), 0.0, 0.1e-3);
  EXPECT_EQ(solid_->EnamelThickness(-0.001), 0.0);
  // no enamel below the neck, and none at a thickness of 0
  int below = 0;
  const MolarSolid bare(MolarShape{.enamel_m = 0.0});
  for (const Vector3& p : PointsAround(solid_->Bounds(), 4000, 0.0)) {
    if (solid_->SignedDistance(p) >= 0.0) continue;
    EXPECT_NE(bare.MaterialAt(p), MolarSolid::kEnamel);
    if (p.z() > -0.3e-3) continue;
    ++below;
    EXPECT_NE(solid_->MaterialAt(p), MolarSolid::kEnamel) << p.transpose();
  }
  EXPECT_GT(below, 500);
}

TEST_F(Molar, TheDrillMeetsEnamelThenDentineThenPulp) {
  std::vector<std::pair<MaterialIndex, double>> met;
  const double top = Top(0.0, 0.0);
  for (double depth = 5e-6; depth < 5e-3; depth += 5e-6) {
    const MaterialIndex material = solid_->MaterialAt({0, 0, top - depth});
    if (met.empty() || met.back().first != material) met.emplace_back(material, depth);
  }
  ASSERT_EQ(met.size(), 3u);
  EXPECT_EQ(met[0].first, MolarSolid::kEnamel);
  EXPECT_EQ(met[1].first, MolarSolid::kDentine);
  EXPECT_NEAR(met[1].second, 2.0e-3, 0.05e-3);
  EXPECT_EQ(met[2].first, MolarSolid::kPulp);
  EXPECT_NEAR(met[2].second, 3.6e-3, 0.2e-3) << "the pulp's roof";
}

TEST_F(Molar, TissuesAddUpToTheTooth) {
  const std::array<double, 8> volumes = Volumes(*solid_, 0.3e-3);
  const double tooth = SignedVolume_m3(mesh_->mesh), pulp = SignedVolume_m3(mesh_->regions[0].mesh);
  EXPECT_NEAR(volumes[0] + volumes[1] + volumes[2], tooth, 0.01 * tooth);
  EXPECT_NEAR(volumes[MolarSolid::kPulp], pulp, 0.03 * pulp);
  EXPECT_GT(volumes[MolarSolid::kEnamel], 200e-9);
}

TEST_F(Molar, ScalesInProportionAndRefusesWrongSizes) {
  const MolarSolid half(MolarShape{.length_m = 0.0103, .enamel_m = 0.001});
  for (const Vector3& p : PointsAround(solid_->Bounds(), 300, 0.1)) {
    ASSERT_NEAR(half.SignedDistance(0.5 * p), 0.5 * solid_->SignedDistance(p), 1e-9);
    if (solid_->SignedDistance(p) < 0.0) {
      ASSERT_EQ(half.MaterialAt(0.5 * p), solid_->MaterialAt(p));
    }
  }
  EXPECT_EQ(Refusal(MolarShape{.length_m = 0.1}), "molar: length: found 100 mm, accepted 10 … 40 mm");
  EXPECT_EQ(Refusal(MolarShape{.pulp_width = 2.0}), "molar: pulp_width: found 2, accepted 0.6 … 1.3");
}

// ---------------------------------------------------------------- femur

TEST(FemurSolid, IsAClosedTubeWithTheVolumeOfItsOvals) {
  const FemurShape shape;
  TriangleMesh mesh = FemurMesh(shape);
  const auto report = CheckMesh(mesh, "femur");
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_FALSE(report->flipped);
  const FemurSolid femur(shape);
  double volume = 0.0;
  constexpr int kSlices = 2000;
  for (int i = 0; i < kSlices; ++i) {
    const FemurSolid::Section section = femur.At(-shape.length_m * (i + 0.5) / kSlices);
    volume += kPi * section.outer_x_m * section.outer_y_m * shape.length_m / kSlices;
  }
  // 96 corners in place of an oval lose (2 pi / 96)² / 6 of its area
  EXPECT_NEAR(SignedVolume_m3(mesh), volume, 1.2e-3 * volume);
  ExpectLipschitzDistanceAndNearestPointsOnSurface(femur);
  for (const Vector3& p : PointsAround(femur.Bounds(), 40, 0.1))
    ASSERT_NEAR(femur.SignedDistance(p), BruteSignedDistance(mesh, p), 1e-9);
}

/// Materials along a ray that leaves the femur, each with the distance in m at which it begins. The last
/// entry is the surface, marked as material 7.
std::vector<std::pair<MaterialIndex, double>> MaterialsAlong(const FemurSolid& femur, const Vector3& from,
                                                             const Vector3& direction) {
  std::vector<std::pair<MaterialIndex, double>> met;
  for (double r = 0.0;; r += 5e-6) {
    const Vector3 p = from + r * direction;
    if (femur.SignedDistance(p) >= 0.0) {
      met.emplace_back(7, r);
      return met;
    }
    const MaterialIndex material = femur.MaterialAt(p);
    if (met.empty() || met.back().first != material) met.emplace_back(material, r);
  }
}

TEST(FemurSolid, WallAndLiningHaveTheGivenThickness) {
  const FemurShape shape;
  const FemurSolid femur(shape);
  struct Place {  // a height, and the wall's thickness there
    double z_m, wall_m;
  };
  for (const Place& place : {Place{-0.0005, shape.top_wall_m}, Place{-0.090, shape.shaft_wall_m}}) {
    for (const Vector3& direction : {Vector3(0, 1, 0), Vector3(0, -1, 0)}) {
      // from the oval's middle, so that the ray runs along its half axis
      const Vector3 from(femur.At(place.z_m).shift_m, 0.0, place.z_m);
      const auto met = MaterialsAlong(femur, from, direction);
      ASSERT_GE(met.size(), 2u);
      EXPECT_EQ(met[met.size() - 2].first, FemurSolid::kCortical);
      EXPECT_NEAR(met.back().second - met[met.size() - 2].second, place.wall_m, 0.03e-3);
    }
  }
  const auto met = MaterialsAlong(femur, {0, 0, -0.090}, {0, 1, 0});
  ASSERT_EQ(met.size(), 4u) << "marrow, cancellous, cortical, outside";
  EXPECT_EQ(met[0].first, FemurSolid::kMarrow);
  EXPECT_EQ(met[1].first, FemurSolid::kCancellous);
  EXPECT_NEAR(met[2].second - met[1].second, shape.shaft_lining_m, 0.02e-3);
  EXPECT_NEAR(MaterialsAlong(femur, {0, 0, -0.0005}, {0, 1, 0})[1].second, shape.top_marrow_radius_m,
              0.02e-3);
}

TEST(FemurSolid, TissuesHaveTheVolumesOfTheirSections) {
  const FemurShape shape;
  const FemurSolid femur(shape);
  double cortical = 0.0, marrow = 0.0;
  constexpr int kSlices = 2000;
  for (int i = 0; i < kSlices; ++i) {
    const FemurSolid::Section s = femur.At(-shape.length_m * (i + 0.5) / kSlices);
    const double slice = kPi * shape.length_m / kSlices;
    cortical += slice * (s.outer_x_m * s.outer_y_m - (s.outer_x_m - s.wall_m) * (s.outer_y_m - s.wall_m));
    marrow += slice * s.marrow_m * s.marrow_m;
  }
  const std::array<double, 8> volumes = Volumes(femur, 1e-3);
  EXPECT_NEAR(volumes[FemurSolid::kCortical], cortical, 0.01 * cortical);
  EXPECT_NEAR(volumes[FemurSolid::kMarrow], marrow, 0.02 * marrow);
}

TEST(FemurSolid, RefusesSizesThatDoNotFit) {
  EXPECT_THAT(Refusal(FemurShape{.shaft_wall_m = 0.012}), HasSubstr("femur: shaft wall: found 12 mm"));
  EXPECT_THAT(Refusal(FemurShape{.shaft_lining_m = 0.009}), HasSubstr("femur: shaft lining: found 9 mm"));
  EXPECT_THAT(Refusal(FemurShape{.oval_ratio = 3.0}), HasSubstr("oval_ratio: found 3, accepted 1 … 1.6"));
  EXPECT_THAT(Refusal(FemurShape{.flare_m = 0.2}), HasSubstr("femur: flare: found 200 mm"));
  EXPECT_THAT(Refusal(FemurShape{.top_marrow_radius_m = 0.03}), HasSubstr("top marrow radius"));
}

// ---------------------------------------------------------------- femoral head

TEST(FemoralHeadSolid, IsAClosedBallOnANeckWithTheVolumeOfBoth) {
  const FemoralHeadShape shape;
  TriangleMesh mesh = FemoralHeadMesh(shape);
  const auto report = CheckMesh(mesh, "femoral head");
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_FALSE(report->flipped);
  // The ball, plus the neck's cylinder from where it leaves the ball, less the ball's cap inside the
  // cylinder. The fillet at the joint adds to this.
  const double R = shape.head_radius_m, r = shape.neck_radius_m, leaves_m = std::sqrt(R * R - r * r);
  const double cap_m = R - leaves_m, cap_m3 = kPi * cap_m * cap_m * (3.0 * R - cap_m) / 3.0;
  const double sharp_m3 =
      4.0 / 3.0 * kPi * R * R * R + kPi * r * r * (shape.neck_length_m - leaves_m) - cap_m3;
  const double volume_m3 = SignedVolume_m3(mesh);
  EXPECT_GT(volume_m3, sharp_m3 * 0.998) << "chords of 1 mm lose (1 mm)^2 / 8 R of depth";
  EXPECT_LT(volume_m3, sharp_m3 * 1.02) << "the fillet";
  const FemoralHeadSolid head(shape);
  ExpectLipschitzDistanceAndNearestPointsOnSurface(head);
  for (const Vector3& p : PointsAround(head.Bounds(), 40, 0.1))
    ASSERT_NEAR(head.SignedDistance(p), BruteSignedDistance(mesh, p), 1e-9);
}

// The scene needs a convex surface where the tool approaches: the head's sphere, from the pole to 80 degrees.
TEST(FemoralHeadSolid, IsASphereWhereTheToolComesFromAboveAndFromTheSides) {
  const FemoralHeadShape shape;
  const FemoralHeadSolid head(shape);
  // MeshOfLevel keeps vertices a twentieth of its 1 mm step away from grid corners, which moves the surface
  // by up to 50 um, as at the pole
  for (double tilt = 0.0; tilt < 1.4; tilt += 0.1)
    for (double turn = 0.05; turn < 6.2; turn += 0.3) {
      const Vector3 n(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt));
      EXPECT_NEAR(head.SignedDistance((shape.head_radius_m + 1e-3) * n), 1e-3, 55e-6);
      EXPECT_NEAR(head.SignedDistance((shape.head_radius_m - 3e-3) * n), -3e-3, 55e-6);
    }
}

TEST(FemoralHeadSolid, TissueIsLayeredByDepth) {
  FemoralHeadShape shape;
  shape.cartilage_m = 0.001;
  const FemoralHeadSolid head(shape);
  const auto at = [&](double depth_m) {
    return head.MaterialAt((shape.head_radius_m - depth_m) * Vector3(0.6, 0.0, 0.8));
  };
  EXPECT_EQ(at(0.0005), FemoralHeadSolid::kCartilage);
  EXPECT_EQ(at(0.0015), FemoralHeadSolid::kCortical);
  EXPECT_EQ(at(0.0030), FemoralHeadSolid::kCancellous);
}

TEST(FemoralHeadSolid, RefusesSizesThatDoNotFit) {
  EXPECT_THAT(Refusal(FemoralHeadShape{.neck_radius_m = 0.023}),
              HasSubstr("femoral head: neck radius: found 23 mm, accepted 5 … 21 mm"));
  EXPECT_THAT(Refusal(FemoralHeadShape{.neck_length_m = 0.02}),
              HasSubstr("femoral head: neck length: found 20 mm"));
  EXPECT_THAT(Refusal(FemoralHeadShape{.neck_tilt_rad = 2.0}), HasSubstr("neck tilt: found 114.6 deg"));
}

}  // namespace
}  // namespace osteon::simulation
