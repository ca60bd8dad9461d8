// Mass, centre and inertia of tools: the closed forms against textbook formulas and numerical integration.
#include <cmath>
#include <numbers>
#include <type_traits>

#include <gtest/gtest.h>

#include "simulation/tools/tool_kinds.h"
#include "simulation/tools/tool_mass.h"

namespace osteon::simulation {
namespace {

constexpr double kPi = std::numbers::pi;

static_assert(std::is_trivially_copyable_v<PlainInertia>);

/// Mass, centre and inertia of a body by its density in kg/m³, summed over the midpoints of n^3 cells of a
/// box. The error is of second order in the cell's size, plus a random part from cells that the surface cuts.
template <typename Density>
MassProperties Integrate(const Eigen::AlignedBox3d& box, int n, const Density& density) {
  const Vector3 step = box.sizes() / n;
  double mass = 0.0;
  Vector3 first = Vector3::Zero();
  Matrix3 second = Matrix3::Zero();
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        const Vector3 p = box.min() + step.cwiseProduct(Vector3(i + 0.5, j + 0.5, k + 0.5));
        const double m = density(p) * step.prod();
        if (m == 0.0) continue;
        mass += m;
        first += m * p;
        second += m * p * p.transpose();
      }
  const Vector3 center = first / mass;
  const Matrix3 about = second - mass * center * center.transpose();
  return {.mass_kg = mass,
          .center_of_mass_m = center,
          .inertia_kg_m2 = about.trace() * Matrix3::Identity() - about};
}

TEST(PlainInertia, RestoresTheSymmetricMatrixItStores) {
  Matrix3 I;
  I << 1, 4, 5, 4, 2, 6, 5, 6, 3;
  EXPECT_EQ(Matrix3(PlainInertia(I)), I);
}

TEST(ToolMass, CylinderConeAndBallHaveTheTextbooksMass) {
  const double rho = 7900.0, r = 0.008, h = 0.05;
  const MassProperties cylinder = CylinderMassProperties(r, -0.01, -0.01 - h, rho);
  const double m = rho * kPi * r * r * h;
  EXPECT_NEAR(cylinder.mass_kg, m, 1e-14 * m);
  EXPECT_NEAR(cylinder.center_of_mass_m.z(), -0.01 - 0.5 * h, 1e-15);
  EXPECT_NEAR(cylinder.inertia_kg_m2(2, 2), 0.5 * m * r * r, 1e-14 * m * r * r);
  EXPECT_NEAR(cylinder.inertia_kg_m2(0, 0), m * (3 * r * r + h * h) / 12, 1e-13 * m * h * h);

  const ProfilePiece cone{.back_z_m = -h, .back_r_m = r};
  const MassProperties pointed = RevolvedMassProperties({&cone, 1}, rho);
  EXPECT_NEAR(pointed.mass_kg, m / 3, 1e-14 * m);
  EXPECT_NEAR(pointed.center_of_mass_m.z(), -0.75 * h, 1e-15);
  EXPECT_NEAR(pointed.inertia_kg_m2(2, 2), 0.3 * m / 3 * r * r, 1e-14 * m * r * r);
  EXPECT_NEAR(pointed.inertia_kg_m2(1, 1), 3.0 / 80.0 * m / 3 * (4 * r * r + h * h), 1e-13 * m * h * h);

  const ProfilePiece ball{.back_z_m = -2 * r, .sphere_radius_m = r, .sphere_z_m = -r};
  const MassProperties round = RevolvedMassProperties({&ball, 1}, rho);
  const double mb = rho * 4.0 / 3.0 * kPi * r * r * r;
  EXPECT_NEAR(round.mass_kg, mb, 1e-14 * mb);
  EXPECT_NEAR(round.center_of_mass_m.z(), -r, 1e-16);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(round.inertia_kg_m2(i, i), 0.4 * mb * r * r, 1e-13 * mb * r * r);
}

TEST(ToolMass, AThinShellTendsToTheTextbooksMass) {
  // hemispherical shell: m = 2 pi r^2 t rho, centre r/2 from the base, I_zz = 2/3 m r^2
  const double r = 0.025, t = 1e-6, rho = 7900.0;
  const MassProperties shell = HemisphericalShellMassProperties(r, t, rho);
  const double m = 2 * kPi * r * r * t * rho;
  // the error is of first order in t/r = 4e-5
  EXPECT_NEAR(shell.mass_kg, m, 1e-4 * m);
  EXPECT_NEAR(shell.volume_m3, m / rho, 1e-4 * m / rho);
  EXPECT_NEAR(shell.center_of_mass_m.z(), -0.5 * r, 1e-4 * r);
  EXPECT_NEAR(shell.inertia_kg_m2(2, 2), 2.0 / 3.0 * m * r * r, 1e-4 * m * r * r);
  EXPECT_NEAR(shell.inertia_kg_m2(0, 0), (2.0 / 3.0 - 0.25) * m * r * r, 1e-4 * m * r * r);
}

TEST(ToolMass, AReamersMassEqualsTheIntegralOverShellShaftAndHolder) {
  const ReamerParams p;
  const double R = 0.5 * p.diameter_m, holder_z = -R - p.shaft_length_m;
  const auto density = [&](const Vector3& q) {
    const double across = std::hypot(q.x(), q.y());
    const double from_center = (q - Vector3(0, 0, -R)).norm();
    if (q.z() >= -R) return from_center <= R && from_center >= R - p.shell_m ? p.density_kg_per_m3 : 0.0;
    if (q.z() >= holder_z) return across <= p.shaft_radius_m ? p.density_kg_per_m3 : 0.0;
    return across <= p.holder.radius_m ? p.holder.density_kg_per_m3 : 0.0;
  };
  const double wide = 0.0316;
  const MassProperties counted =
      Integrate({Vector3(-wide, -wide, -0.180), Vector3(wide, wide, 0)}, 180, density);
  const Tool tool = MakeReamer(p).tool;
  // cells are 0.35 mm wide; a cylinder of 31.5 mm is counted to a few thousandths of its section
  EXPECT_NEAR(tool.mass_kg, counted.mass_kg, 4e-3 * tool.mass_kg);
  EXPECT_NEAR(tool.center_of_mass_m.z, counted.center_of_mass_m.z(), 0.2e-3);
  const Matrix3 I = tool.inertia_kg_m2;
  EXPECT_LT((I - counted.inertia_kg_m2).cwiseAbs().maxCoeff(), 5e-3 * I(0, 0));
  EXPECT_NEAR(I(2, 2), counted.inertia_kg_m2(2, 2), 5e-3 * I(2, 2));
  EXPECT_EQ(I(0, 1), 0.0);
}

TEST(ToolMass, ADrillsMassEqualsTheIntegralOverPointFlutesAndShank) {
  TwistDrillParams p;
  p.holder = {.radius_m = 1e-3, .length_m = 1e-3, .density_kg_per_m3 = 100.0};
  const double R = 0.5 * p.diameter_m;
  const auto density = [&](const Vector3& q) {
    const double across = std::hypot(q.x(), q.y()), along = -q.z();
    if (across > R || across > along * std::tan(0.5 * p.point_rad)) return 0.0;
    return along <= p.flute_length_m ? p.flute_metal_ratio * p.density_kg_per_m3 : p.density_kg_per_m3;
  };
  const MassProperties counted = Integrate({Vector3(-R, -R, -p.length_m), Vector3(R, R, 0)}, 150, density);
  const Tool tool = MakeTwistDrill(p).tool;
  const double holder_kg = 100.0 * kPi * 1e-9;
  EXPECT_NEAR(tool.mass_kg - holder_kg, counted.mass_kg, 2e-3 * counted.mass_kg);
  EXPECT_NEAR(tool.center_of_mass_m.z, counted.center_of_mass_m.z(), 0.2e-3);
  EXPECT_NEAR(tool.inertia_kg_m2.zz, counted.inertia_kg_m2(2, 2), 5e-3 * counted.inertia_kg_m2(2, 2));
  EXPECT_NEAR(tool.inertia_kg_m2.xx, counted.inertia_kg_m2(0, 0), 5e-3 * counted.inertia_kg_m2(0, 0));
}

TEST(ToolMass, ABurrsMassEqualsTheIntegralOverItsOutline) {
  for (const BurrShape shape : {BurrShape::kRound, BurrShape::kPear, BurrShape::kTaper}) {
    BurrParams p{.shape = shape,
                 .diameter_m = 6e-3,
                 .head_length_m = 12e-3,
                 .tip_diameter_m = 3e-3,
                 .neck_diameter_m = 2e-3,
                 .length_m = 30e-3};
    p.balls = {.max_count = 100, .cutting_gap_m = 0.2e-3};
    p.holder = {.radius_m = 1e-3, .length_m = 1e-3, .density_kg_per_m3 = 100.0};
    const BuiltTool built = MakeBurr(p);
    const auto density = [&](const Vector3& q) {
      return q.z() > -p.length_m && built.profile->SignedDistance(q) < 0.0 ? p.density_kg_per_m3 : 0.0;
    };
    const MassProperties counted =
        Integrate({Vector3(-3e-3, -3e-3, -30e-3), Vector3(3e-3, 3e-3, 0)}, 100, density);
    EXPECT_NEAR(built.tool.mass_kg, counted.mass_kg, 3e-3 * counted.mass_kg) << built.tool.name;
    EXPECT_NEAR(built.tool.center_of_mass_m.z, counted.center_of_mass_m.z(), 0.1e-3) << built.tool.name;
    EXPECT_NEAR(built.tool.inertia_kg_m2.xx, counted.inertia_kg_m2(0, 0), 1e-2 * counted.inertia_kg_m2(0, 0));
    EXPECT_NEAR(built.tool.inertia_kg_m2.zz, counted.inertia_kg_m2(2, 2), 1e-2 * counted.inertia_kg_m2(2, 2));
  }
}

}  // namespace
}  // namespace osteon::simulation
