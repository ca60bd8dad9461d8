#include "simulation/tools/tool_kinds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "base/check_range.h"

namespace osteon::simulation {
namespace {

// Fraction of the accepted gap that is allowed at the samples; the rest is a margin for the surface between
// samples.
constexpr double kSampleGapFraction = 0.85;

void CheckDensity(const std::string& name, double density_kg_per_m3) {
  if (density_kg_per_m3 >= 100.0 && density_kg_per_m3 <= 25'000.0) return;
  throw std::invalid_argument(
      fmt::format("{}: found {:.6g} kg/m3, accepted 100 … 25000 kg/m3", name, density_kg_per_m3));
}

void CheckHolder(const std::string& name, const HolderParams& holder) {
  CheckRangeMm(name + ": holder radius", holder.radius_m, 1e-3, 0.2);
  CheckRangeMm(name + ": holder length", holder.length_m, 1e-3, 0.5);
  CheckDensity(name + ": holder density", holder.density_kg_per_m3);
}

/// Mass of a holder that begins at front_z_m, in T.
MassProperties HolderMass(const HolderParams& holder, double front_z_m) {
  return CylinderMassProperties(holder.radius_m, front_z_m, front_z_m - holder.length_m,
                                holder.density_kg_per_m3);
}

/// Builds the outline of a turned tool as points (z, r), from the apex towards the holder.
class Outline {
 public:
  explicit Outline(const BallParams& balls) : balls_(balls) {}

  /// Adds a straight line to the point (z, r), unless it would have no length.
  Outline& LineTo(double z_m, double r_m, bool cutting) {
    constexpr double kNothing_m = 1e-9;  // a shorter line is left out
    if (std::abs(z_m - z_m_) < kNothing_m && std::abs(r_m - r_m_) < kNothing_m) return *this;
    return Add({.back_z_m = z_m, .back_r_m = r_m, .cutting = cutting});
  }
  /// Adds an arc to the height z. Its circle is centred on the axis.
  Outline& ArcTo(double z_m, double center_z_m, double radius_m, bool cutting) {
    const double dz = z_m - center_z_m;
    return Add({.back_z_m = z_m,
                .back_r_m = std::sqrt(std::max(0.0, radius_m * radius_m - dz * dz)),
                .sphere_radius_m = radius_m,
                .sphere_z_m = center_z_m,
                .cutting = cutting});
  }
  ProfilePiece& last() { return pieces_.back(); }
  [[nodiscard]] double z_m() const { return z_m_; }
  [[nodiscard]] double r_m() const { return r_m_; }
  [[nodiscard]] std::vector<ProfilePiece> TakePieces() { return std::move(pieces_); }

 private:
  Outline& Add(ProfilePiece piece) {
    piece.front_z_m = z_m_;
    piece.front_r_m = r_m_;
    piece.gap_m = piece.cutting ? balls_.cutting_gap_m : balls_.touching_gap_m;
    z_m_ = piece.back_z_m;
    r_m_ = piece.back_r_m;
    pieces_.push_back(piece);
    return *this;
  }

  BallParams balls_;
  std::vector<ProfilePiece> pieces_;
  double z_m_{0.0}, r_m_{0.0};
};

}  // namespace

void CheckBallsAndHolder(const std::string& name, const BallParams& balls, const HolderParams& holder,
                         double density_kg_per_m3) {
  CheckRangeMm(name + ": cutting gap", balls.cutting_gap_m, 1e-6, 5e-3);
  CheckRangeMm(name + ": touching gap", balls.touching_gap_m, 1e-6, 5e-3);
  if (balls.max_count < 1 || balls.max_count > 10'000)
    throw std::invalid_argument(
        fmt::format("{}: greatest count: found {}, accepted 1 … 10000", name, balls.max_count));
  CheckHolder(name, holder);
  CheckDensity(name + ": density", density_kg_per_m3);
}

Tool FitBalls(const std::string& name, const Solid& solid,
              const std::function<std::vector<SurfaceSample>(std::size_t)>& sample,
              const std::vector<ToolBall>& first, std::size_t max_count) {
  // smallest number of samples per ball for which a fit is accepted
  constexpr std::size_t kSamplesPerBall = 120;
  const ToolFitParams params{.max_count = max_count};
  std::vector<SurfaceSample> samples;
  ToolFit fit;
  // Repeat the fit with four times as many samples until there are enough samples for the number of balls, or
  // the balls do not suffice.
  for (std::size_t count = 16'000;; count *= 4) {
    samples = sample(count);
    for (SurfaceSample& s : samples) s.gap_m *= kSampleGapFraction;
    fit = FitTool(solid, samples, first, params);
    if (fit.worst_ratio > 1.0 || fit.balls.size() * kSamplesPerBall <= count) break;
  }
  if (fit.worst_ratio > 1.0) {
    double scale = 1.0;  // factor on the gaps at which max_count balls suffice
    while (fit.worst_ratio > 1.0 && scale < 1e3) {
      scale *= 1.2;
      for (SurfaceSample& s : samples) s.gap_m *= 1.2;
      fit = FitTool(solid, samples, first, params);
    }
    throw std::invalid_argument(fmt::format(
        "{}: greatest count: found {}, accepted more: so many balls suffice for gaps {:.2g} times as "
        "large",
        name, max_count, scale));
  }
  Tool tool{.name = name, .balls = std::move(fit.balls)};
  // The head comes first, the other balls stay in their order.
  if (const ToolBall* head = CuttingHead(tool)) {
    const auto at = tool.balls.begin() + (head - tool.balls.data());
    std::rotate(tool.balls.begin(), at, at + 1);
  }
  return tool;
}

BuiltTool MakeTurnedTool(const std::string& name, std::vector<ProfilePiece> pieces, double density_kg_per_m3,
                         const BallParams& balls, const HolderParams& holder,
                         const std::vector<ToolBall>& first) {
  CheckBallsAndHolder(name, balls, holder, density_kg_per_m3);
  const auto profile = std::make_shared<const ToolProfile>(std::move(pieces));
  const auto sample = [&](std::size_t count) { return profile->Sample(count, 0); };
  BuiltTool built{.tool = FitBalls(name, *profile, sample, first, balls.max_count),
                  .length_m = profile->length_m() + holder.length_m,
                  .profile = profile,
                  .beam = BeamOf(*profile)};
  const std::array<MassProperties, 2> bodies{RevolvedMassProperties(profile->pieces(), density_kg_per_m3),
                                             HolderMass(holder, -profile->length_m())};
  SetMass(Combine(bodies), built.tool);
  return built;
}

BuiltTool MakeReamer(const ReamerParams& p) {
  const std::string name = fmt::format("hemispherical reamer {:.10g} mm", p.diameter_m * 1e3);
  const double radius_m = 0.5 * p.diameter_m;
  CheckRangeMm("reamer: diameter", p.diameter_m, 2e-3, 0.2);
  CheckRangeMm(name + ": shell", p.shell_m, 1e-4, 0.9 * radius_m);
  CheckRangeMm(name + ": shaft length", p.shaft_length_m, 0.0, 0.5);
  CheckDensity(name + ": density", p.density_kg_per_m3);
  CheckHolder(name, p.holder);

  BuiltTool built;
  built.tool = MakeReamer(radius_m, p.shaft_radius_m, p.touching_length_m, 1.0, Vector3::Zero());
  built.tool.name = name;
  built.length_m = radius_m + (p.shaft_length_m + p.holder.length_m);
  const double front_m = radius_m + p.shaft_length_m;
  built.beam = {{.from_m = 0.0, .to_m = radius_m, .rigid = true},
                {.from_m = radius_m,
                 .to_m = front_m,
                 .from_radius_m = p.shaft_radius_m,
                 .to_radius_m = p.shaft_radius_m}};
  built.load_point_m = radius_m;
  const MassProperties shell = HemisphericalShellMassProperties(radius_m, p.shell_m, p.density_kg_per_m3);
  built.head_mass_kg = shell.mass_kg;
  const std::array<MassProperties, 3> bodies{
      shell, CylinderMassProperties(p.shaft_radius_m, -radius_m, -front_m, p.density_kg_per_m3),
      HolderMass(p.holder, -front_m)};
  SetMass(Combine(bodies), built.tool);
  return built;
}

BuiltTool MakeBurr(const BurrParams& p) {
  static constexpr std::array<const char*, 5> kNames{"round", "pear", "cylinder", "taper", "flat cylinder"};
  const std::string name =
      fmt::format("{} burr {:.10g} mm", kNames[static_cast<std::size_t>(p.shape)], p.diameter_m * 1e3);
  const double R = 0.5 * p.diameter_m, neck_m = 0.5 * p.neck_diameter_m, shank_m = 0.5 * p.shank_diameter_m;
  CheckRangeMm("burr: diameter", p.diameter_m, 0.2e-3, 0.05);
  CheckRangeMm(name + ": neck diameter", p.neck_diameter_m, 0.1e-3,
               std::min(0.99 * p.diameter_m, p.shank_diameter_m));
  CheckRangeMm(name + ": neck length", p.neck_length_m, 0.0, 0.2);
  CheckRangeMm(name + ": shank diameter", p.shank_diameter_m, 0.5e-3, 0.05);
  if (p.shape != BurrShape::kRound)
    CheckRangeMm(name + ": head length", p.head_length_m, 1.01 * p.diameter_m, 0.2);

  constexpr double kBackSlope = 0.36397023426620234;  // tan 20 deg
  Outline outline(p.balls);
  std::vector<ToolBall> first;
  // Adds a ball of radius tip_m at the tip and the cone that is tangent to it, back to the radius back_m at
  // the head's end. `angle` is that of the tangent point, seen from the ball's centre and measured from -z.
  const auto add_ball_and_cone = [&](double tip_m, double back_m) {
    const double behind_m = p.head_length_m - tip_m;
    const double angle = std::atan2(back_m, behind_m) + std::acos(tip_m / std::hypot(back_m, behind_m));
    outline.ArcTo(-tip_m - tip_m * std::cos(angle), -tip_m, tip_m, true)
        .LineTo(-p.head_length_m, back_m, true);
  };
  switch (p.shape) {
    case BurrShape::kRound:
      outline.ArcTo(-R - std::sqrt(R * R - neck_m * neck_m), -R, R, true);
      first.push_back({.center_m = Vector3(0, 0, -R), .radius_m = R, .cutting = true});
      break;
    case BurrShape::kPear:
      add_ball_and_cone(R, neck_m);
      break;
    case BurrShape::kCylinder:
      add_ball_and_cone(R, R);
      break;
    case BurrShape::kTaper:
      CheckRangeMm(name + ": tip diameter", p.tip_diameter_m, 0.1e-3, p.diameter_m);
      add_ball_and_cone(0.5 * p.tip_diameter_m, R);
      break;
    case BurrShape::kFlatCylinder:
      outline.LineTo(0.0, R, true).LineTo(-p.head_length_m, R, true);
      break;
  }
  outline.LineTo(outline.z_m() - (outline.r_m() - neck_m) / kBackSlope, neck_m, true);
  outline.LineTo(outline.z_m() - p.neck_length_m, neck_m, false);
  outline.LineTo(outline.z_m() - (shank_m - neck_m) / kBackSlope, shank_m, false);
  CheckRangeMm(name + ": length", p.length_m, -outline.z_m() + 1e-3, 0.3);
  outline.LineTo(-p.length_m, shank_m, false);
  BuiltTool built = MakeTurnedTool(name, outline.TakePieces(), p.density_kg_per_m3, p.balls, p.holder, first);
  built.load_point_m = R;
  built.head_mass_kg = p.density_kg_per_m3 * 4.0 / 3.0 * std::numbers::pi * R * R * R;
  return built;
}

BuiltTool MakeTwistDrill(const TwistDrillParams& p) {
  const std::string name = fmt::format("twist drill {:.10g} mm", p.diameter_m * 1e3);
  const double R = 0.5 * p.diameter_m;
  CheckRangeMm("twist drill: diameter", p.diameter_m, 0.5e-3, 0.05);
  if (!(p.point_rad >= 1.0 && p.point_rad <= 3.1))
    throw std::invalid_argument(fmt::format("{}: point: found {:.6g} deg, accepted 57.3 … 177.6 deg", name,
                                            p.point_rad * 180.0 / std::numbers::pi));
  const double point_m = R / std::tan(0.5 * p.point_rad);
  CheckRangeMm(name + ": flute length", p.flute_length_m, point_m + 1e-4, 0.5);
  CheckRangeMm(name + ": length", p.length_m, p.flute_length_m, 0.5);
  CheckRangeMm(name + ": flute gap", p.flute_gap_m, 1e-6, 5e-3);

  Outline outline(p.balls);
  outline.LineTo(-point_m, R, true);
  outline.last().metal_ratio = p.flute_metal_ratio;
  outline.LineTo(-p.flute_length_m, R, true);
  outline.last().metal_ratio = p.flute_metal_ratio;
  outline.last().gap_m = p.flute_gap_m;
  outline.LineTo(-p.length_m, R, false);
  return MakeTurnedTool(name, outline.TakePieces(), p.density_kg_per_m3, p.balls, p.holder);
}

}  // namespace osteon::simulation
