#include "procedure/plan/cup_axis.h"

#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "base/units.h"
#include "procedure/plan/pelvic_frame.h"

namespace osteon::procedure {
namespace {

constexpr double kRoundTrip = 1e-12;  // error accepted after a conversion there and back [rad]
constexpr CupDefinition kDefinitions[] = {CupDefinition::kRadiographic, CupDefinition::kOperative,
                                          CupDefinition::kAnatomic};

CupAngles Degrees(double inclination, double anteversion) {
  return {inclination * kDegree, anteversion * kDegree};
}

// Expected values have four decimals: the tolerance is a little more than half a unit of the last one.
void ExpectDegrees(const CupAngles& angles, double inclination, double anteversion) {
  EXPECT_NEAR(angles.inclination_rad / kDegree, inclination, 6e-5);
  EXPECT_NEAR(angles.anteversion_rad / kDegree, anteversion, 6e-5);
}

TEST(CupAxis, RadiographicAnglesConvertToTheOtherDefinitions) {
  const Vector3 usual = CupAxis_N(CupDefinition::kRadiographic, Degrees(40, 15));
  ExpectDegrees(AnglesOf(CupDefinition::kOperative, usual), 38.3808, 19.2790);
  ExpectDegrees(AnglesOf(CupDefinition::kAnatomic, usual), 42.2735, 22.6291);
  const Vector3 steep = CupAxis_N(CupDefinition::kRadiographic, Degrees(45, 20));
  ExpectDegrees(AnglesOf(CupDefinition::kOperative, steep), 41.6411, 27.2363);
  ExpectDegrees(AnglesOf(CupDefinition::kAnatomic, steep), 48.3589, 27.2363);
}

// Each definition by its meaning instead of its formula: radiographic anteversion is the angle to the coronal
// plane, operative inclination that to the sagittal plane, anatomic inclination that to the longitudinal
// axis.
TEST(CupAxis, EachDefinitionIsTheAngleToItsPlane) {
  for (const CupDefinition definition : kDefinitions) {
    const Vector3 a_N = CupAxis_N(definition, Degrees(47, 23));
    EXPECT_NEAR(a_N.norm(), 1.0, 1e-15);
    EXPECT_NEAR(AnglesOf(CupDefinition::kRadiographic, a_N).anteversion_rad, std::asin(a_N.y()), 1e-14);
    EXPECT_NEAR(AnglesOf(CupDefinition::kOperative, a_N).inclination_rad, std::asin(a_N.x()), 1e-14);
    EXPECT_NEAR(AnglesOf(CupDefinition::kAnatomic, a_N).inclination_rad, std::acos(-a_N.z()), 1e-14);
  }
}

TEST(CupAxis, ConversionsThereAndBackChangeNothing) {
  EXPECT_TRUE(rc::check("angles of a definition, by an axis, to angles", [] {
    const CupAngles angles =
        Degrees(*rc::gen::inRange(1, 90'000) * 1e-3, *rc::gen::inRange(-59'999, 90'000) * 1e-3);
    for (const CupDefinition definition : kDefinitions) {
      if (definition == CupDefinition::kRadiographic && angles.anteversion_rad > 1.57) continue;
      const CupAngles back = AnglesOf(definition, CupAxis_N(definition, angles));
      RC_ASSERT(std::abs(back.inclination_rad - angles.inclination_rad) <= kRoundTrip);
      // near a pole of a definition the axis hardly depends on the anteversion
      const double lever = definition == CupDefinition::kAnatomic    ? std::sin(angles.inclination_rad)
                           : definition == CupDefinition::kOperative ? std::cos(angles.inclination_rad)
                                                                     : std::cos(angles.anteversion_rad);
      RC_ASSERT(lever * std::abs(back.anteversion_rad - angles.anteversion_rad) <= kRoundTrip);
    }
  }));
  EXPECT_TRUE(rc::check("an axis, by every definition, to the axis", [] {
    const Vector3 a_N(*rc::gen::inRange(0, 1000), *rc::gen::inRange(-1000, 1001),
                      -*rc::gen::inRange(1, 1001));
    for (const CupDefinition definition : kDefinitions)
      RC_ASSERT((CupAxis_N(definition, AnglesOf(definition, a_N)) - a_N.normalized()).norm() <= kRoundTrip);
  }));
}

TEST(CupAxis, APosteriorTiltAddsToTheOperativeAnteversionAlone) {
  const PelvicFrame pelvis;
  const Vector3 a_G = pelvis.ToG(CupAxis_N(CupDefinition::kRadiographic, Degrees(40, 15)));
  const double tau = 13.0 * kDegree;
  const CupAngles flat = AnglesOf(CupDefinition::kOperative, pelvis.FromG(a_G));
  const CupAngles tilted = AnglesOf(CupDefinition::kOperative, Tilted(pelvis, tau).FromG(a_G));
  EXPECT_NEAR(tilted.inclination_rad, flat.inclination_rad, 1e-15);
  EXPECT_NEAR(tilted.anteversion_rad, flat.anteversion_rad + tau, 1e-15);
  EXPECT_NEAR(
      AnglesOf(CupDefinition::kRadiographic, Tilted(pelvis, tau).FromG(a_G)).anteversion_rad / kDegree, 24.75,
      5e-3);
}

}  // namespace
}  // namespace osteon::procedure
