#include "procedure/plan/cup_axis.h"

#include <cmath>

namespace osteon::procedure {

const char* NameOf(CupDefinition definition) {
  switch (definition) {
    case CupDefinition::kRadiographic:
      return "radiographic";
    case CupDefinition::kOperative:
      return "operative";
    case CupDefinition::kAnatomic:
      return "anatomic";
  }
  return "";
}

Vector3 CupAxis_N(CupDefinition definition, const CupAngles& angles) {
  const double si = std::sin(angles.inclination_rad), ci = std::cos(angles.inclination_rad);
  const double sa = std::sin(angles.anteversion_rad), ca = std::cos(angles.anteversion_rad);
  switch (definition) {
    case CupDefinition::kRadiographic:
      return {si * ca, sa, -ci * ca};
    case CupDefinition::kOperative:
      return {si, ci * sa, -ci * ca};
    case CupDefinition::kAnatomic:
      return {si * ca, si * sa, -ci};
  }
  return Vector3::Zero();
}

// asin and acos lose half of their digits near 1, so each angle is computed as an arctangent.
CupAngles AnglesOf(CupDefinition definition, const Vector3& a_N) {
  const double L = a_N.x(), A = a_N.y(), I = -a_N.z();
  switch (definition) {
    case CupDefinition::kRadiographic:
      return {std::atan2(L, I), std::atan2(A, std::hypot(L, I))};
    case CupDefinition::kOperative:
      return {std::atan2(L, std::hypot(A, I)), std::atan2(A, I)};
    case CupDefinition::kAnatomic:
      return {std::atan2(std::hypot(L, A), I), std::atan2(A, L)};
  }
  return {};
}

}  // namespace osteon::procedure
