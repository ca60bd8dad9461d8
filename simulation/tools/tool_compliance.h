#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "simulation/tools/tool_profile.h"

// Compliance of a tool. The tool is a cantilever of round pieces from its apex to the clamp.
//
//     apex, s = 0 ◖head▏ neck ▏  shaft, D(s)  ▨▨▨ clamped
//                 ◀────── s ──────────────────▶ L

namespace osteon::simulation {

/// Rows and columns: translation x, y, z, then rotation x, y, z; or force and torque.
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// A round piece of a tool, between two distances from the apex. Its radius changes linearly along the axis.
struct BeamPiece {
  double from_m{0.0}, to_m{0.0};  ///< distances of its ends from the apex
  double from_radius_m{0.0}, to_radius_m{0.0};
  bool rigid{false};  ///< true: a piece of the head, whose own bending is neglected
  /// Second moment of area over the full circle's; used for bending and torsion
  double second_moment_ratio{1.0};
  double area_ratio{1.0};  ///< area over the full circle's
};

/// Second moment of area of a fluted shaft over that of the full circle: cutters with flutes bend like a
/// cylinder of 0.8 D, 0.8^4 = 0.41. Source: Kops and Vo 1990 (abstract read), measured at end mills; assumed
/// for drills.
inline constexpr double kFlutedSecondMoment = 0.41;

/// Material, clamp and load of a tool that bends.
struct BeamParams {
  double youngs_Pa{193e9};  ///< stainless steel
  double poisson{0.29};
  double density_kg_per_m3{7900.0};
  double clamped_m{0.0};     ///< length of the rearmost piece inside the chuck; the rest is free
  double load_point_m{0.0};  ///< distance behind the apex where bone pushes the tool aside
  double head_mass_kg{0.0};  ///< of the rigid pieces
};

/// A tool's compliance at its apex, with its buckling thrust and its first frequency.
struct ToolCompliance {
  /// Compliance matrix: displacement and rotation of T for a wrench on T, both in T. Signs: C(0,4) > 0,
  /// C(1,3) < 0.
  Matrix6 C_T{Matrix6::Zero()};
  double free_length_m{0.0};    ///< from the apex to the clamp
  double lateral_N_per_m{0.0};  ///< stiffness against a lateral force at load_point_m
  double buckling_N{0.0};       ///< axial thrust at which the free length buckles
  /// First frequency of lateral vibration: sqrt(k / (m_head + 0.236 m_shaft)) / 2 pi
  double first_mode_hz{0.0};
};

/// Computes the compliance by sums over slices of the free length L. D(s^n) is the difference of s^n between
/// a slice's ends, s being the distance from the apex; y is lateral displacement, t rotation:
///
///     c_yy = sum D(s^3) / 3EI,  c_yt = sum D(s^2) / 2EI,  c_tt = sum Ds / EI,  axial Ds / EA, torsion Ds / GJ
///
/// Deflections are assumed small, and cross-sections stay plane. Shear is neglected; its part is below 1 % if
/// L is more than 6 diameters.
/// @param pieces  from the apex back, joined, at least one of them flexible and free
/// @throws std::invalid_argument naming the figure, its value and what is accepted.
[[nodiscard]] ToolCompliance CantileverCompliance(std::span<const BeamPiece> pieces,
                                                  const BeamParams& params);

/// Compliance against a lateral force at a point behind the apex, at that point [m/N]. The tool is assumed to
/// be rigid from the apex to this point. If a length s of this part bends, the result is too large by the
/// relative amount (s / (L - s))^3.
[[nodiscard]] double LateralCompliance(const Matrix6& C_T, double behind_apex_m);

/// Factor by which an axial thrust P increases the lateral compliance: 1 / (1 - P / P_cr), P_cr being the
/// buckling thrust.
/// @throws std::invalid_argument unless 0 <= thrust < buckling.
[[nodiscard]] double ThrustFactor(double thrust_N, double buckling_N);

/// The pieces of a turned tool's outline. The pieces of the cutting head up to its widest point are rigid;
/// fluted pieces have the second moment ratio kFlutedSecondMoment, and the profile's share of metal as area
/// ratio.
[[nodiscard]] std::vector<BeamPiece> BeamOf(const ToolProfile& profile);

}  // namespace osteon::simulation
