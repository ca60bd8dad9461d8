#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "simulation/tools/tool_profile.h"

// How far a tool bends: a cantilever of round pieces from its apex to where it is clamped.
//
//     apex, s = 0 ◖head▏ neck ▏  shaft, D(s)  ▨▨▨ clamped
//                 ◀────── s ──────────────────▶ L

namespace osteon::simulation {

/// Rows and columns: translation x, y, z, then rotation x, y, z; or force and torque.
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// A round piece of a tool between two distances behind its apex. Its radius changes linearly.
struct BeamPiece {
  double from_m{0.0}, to_m{0.0};  ///< distance behind the apex
  double from_radius_m{0.0}, to_radius_m{0.0};
  bool rigid{false};                ///< a head, whose own bending does not count
  double second_moment_ratio{1.0};  ///< second moment of area over the full circle's; also of torsion
  double area_ratio{1.0};           ///< area over the full circle's
};

/// Second moment of area of a fluted shaft over that of the full circle: cutters with flutes bend like a
/// cylinder of 0.8 D, 0.8^4 = 0.41. Source: Kops and Vo 1990 (abstract read), measured at end mills, taken
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

/// A tool's compliance at its apex, and what bounds it.
struct ToolCompliance {
  /// Displacement of the apex's frame by a wrench on it, both in T: C(0,4) > 0, C(1,3) < 0.
  Matrix6 C_T{Matrix6::Zero()};
  double free_length_m{0.0};    ///< from the apex to the clamp
  double lateral_N_per_m{0.0};  ///< stiffness against a lateral force at load_point_m
  double buckling_N{0.0};       ///< axial thrust at which the free length buckles
  double first_mode_hz{0.0};    ///< of lateral vibration: sqrt(k / (m_head + 0.236 m_shaft)) / 2 pi
};

/// Cantilever sums over the free length, by the distance s from the apex:
///
///     c_yy = sum D(s^3) / 3EI,  c_yt = sum D(s^2) / 2EI,  c_tt = sum Ds / EI,  axial Ds / EA, torsion Ds / GJ
///
/// Small deflections; plane sections; shear is left out, which is below 1 % where L > 6 D.
/// @param pieces  from the apex back, joined, at least one of them flexible and free
/// @throws std::invalid_argument naming the figure, its value and what is accepted.
[[nodiscard]] ToolCompliance CantileverCompliance(std::span<const BeamPiece> pieces,
                                                  const BeamParams& params);

/// Compliance against a lateral force at a point behind the apex, at that point [m/N]. The tool counts as
/// rigid from the apex to this point: if a length s of this part bends, the result is too large by the
/// fraction (s / (L - s))^3.
[[nodiscard]] double LateralCompliance(const Matrix6& C_T, double behind_apex_m);

/// Factor on the compliance under an axial thrust: 1 / (1 - P / P_cr).
/// @throws std::invalid_argument unless 0 <= thrust < buckling.
[[nodiscard]] double ThrustFactor(double thrust_N, double buckling_N);

/// The pieces of a turned tool's outline. The pieces of the cutting head up to its widest point are rigid;
/// where flutes are cut, the section is kFlutedSecondMoment and the piece's share of metal.
[[nodiscard]] std::vector<BeamPiece> BeamOf(const ToolProfile& profile);

}  // namespace osteon::simulation
