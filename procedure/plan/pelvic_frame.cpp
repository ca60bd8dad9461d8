#include "procedure/plan/pelvic_frame.h"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

namespace osteon::procedure {
namespace {

// Smallest accepted distance between the spines, and of the pubis from the line through them. Nearer
// landmarks do not determine the plane.
constexpr double kMinSpineDistance_m = 0.05, kMinPubisDistance_m = 0.02;
// largest cosine of the angle between two axes that count as perpendicular
constexpr double kMaxCosine = 1e-3;

}  // namespace

const char* NameOf(Side side) { return side == Side::kRight ? "right" : "left"; }

PelvicFrame FrameOf(const PelvicLandmarks& landmarks, Side side) {
  const Vector3 across_m = landmarks.asis_left_m - landmarks.asis_right_m;
  if (!(across_m.norm() >= kMinSpineDistance_m))
    throw std::invalid_argument(fmt::format("found spines {:.4g} mm apart, accepted at least {:g} mm",
                                            1e3 * across_m.norm(), 1e3 * kMinSpineDistance_m));
  const Vector3 t = across_m.normalized();
  const Vector3 up_m = 0.5 * (landmarks.asis_right_m + landmarks.asis_left_m) - landmarks.pubis_m;
  const Vector3 normal_m = up_m - up_m.dot(t) * t;
  if (!(normal_m.norm() >= kMinPubisDistance_m))
    throw std::invalid_argument(
        fmt::format("found the pubis {:.4g} mm from the line through the spines, accepted at least {:g} mm",
                    1e3 * normal_m.norm(), 1e3 * kMinPubisDistance_m));
  const Vector3 superior = normal_m.normalized();
  return {
      .lateral = side == Side::kLeft ? t : Vector3(-t), .anterior = t.cross(superior), .superior = superior};
}

void CheckFrame(const PelvicFrame& frame, Side side) {
  const double max_cosine =
      std::max({std::abs(frame.lateral.dot(frame.anterior)), std::abs(frame.lateral.dot(frame.superior)),
                std::abs(frame.anterior.dot(frame.superior))});
  if (!(max_cosine <= kMaxCosine))
    throw std::invalid_argument(fmt::format(
        "found axes {:.4g} from perpendicular (cosine), accepted at most {:g}", max_cosine, kMaxCosine));
  const double forwards = frame.lateral.cross(frame.superior).dot(frame.anterior);
  if ((forwards > 0.0) != (side == Side::kLeft))
    throw std::invalid_argument(fmt::format("found axes of a {} hip, accepted those of a {} hip (side)",
                                            NameOf(side == Side::kLeft ? Side::kRight : Side::kLeft),
                                            NameOf(side)));
}

PelvicFrame Tilted(const PelvicFrame& frame, double tau_rad) {
  const double c = std::cos(tau_rad), s = std::sin(tau_rad);
  return {.lateral = frame.lateral,
          .anterior = c * frame.anterior - s * frame.superior,
          .superior = c * frame.superior + s * frame.anterior};
}

CupAngles LandmarkSpread(const PelvicLandmarks& landmarks, Side side, double tau_rad,
                         CupDefinition definition, const Vector3& a_G, double sd_m) {
  constexpr double kStep_m = 1e-5;  // step of a coordinate for central differences
  const auto angles = [&](const PelvicLandmarks& moved) {
    return AnglesOf(definition, Tilted(FrameOf(moved, side), tau_rad).FromG(a_G));
  };
  CupAngles sum;
  constexpr std::array kPoints{&PelvicLandmarks::asis_right_m, &PelvicLandmarks::asis_left_m,
                               &PelvicLandmarks::pubis_m};
  for (const auto point : kPoints)
    for (int axis = 0; axis < 3; ++axis) {
      PelvicLandmarks ahead = landmarks, behind = landmarks;
      (ahead.*point)(axis) += kStep_m;
      (behind.*point)(axis) -= kStep_m;
      const CupAngles a = angles(ahead), b = angles(behind);
      // the variances of independent coordinates add up
      const double scale = sd_m / (2.0 * kStep_m);
      sum.inclination_rad += std::pow(scale * (a.inclination_rad - b.inclination_rad), 2);
      sum.anteversion_rad += std::pow(scale * (a.anteversion_rad - b.anteversion_rad), 2);
    }
  return {std::sqrt(sum.inclination_rad), std::sqrt(sum.anteversion_rad)};
}

}  // namespace osteon::procedure
