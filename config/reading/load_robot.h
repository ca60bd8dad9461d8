#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "config/reading/strict/reader.h"
#include "kinematics/chain_params.h"
#include "kinematics/ortho_parallel_params.h"

namespace osteon::config {

/// An arm as its file describes it.
struct RobotModel {
  std::string name;
  std::variant<kinematics::ChainParams<7>, kinematics::ChainParams<6>> chain;
  /// The chain's source, if the file gives an ortho-parallel arm.
  std::optional<kinematics::OrthoParallelParams> ortho_parallel;

  [[nodiscard]] int joint_count() const { return chain.index() == 0 ? 7 : 6; }
};

/// Reads a file of config/robots, in one of two forms. Joint by joint, 6 or 7 of them:
///
///     name: …
///     joints:
///       - name: A1                        in this order: A1, A2 …
///         origin: {position_mm: [x, y, z], rpy_deg: [r, p, y]}      in the previous link, all joints at zero
///         axis: [x, y, z]                                           in the joint's own frame
///         limits: {lower_deg: , upper_deg: , velocity_deg_per_s: , acceleration_rad_per_s2: , torque_Nm: }
///         link: {mass_kg: , center_mm: [], inertia_kg_m2: [xx, yy, zz, xy, xz, yz]}      all or none
///         friction: {viscous_Nms_per_rad: , coulomb_Nm: , smoothing_deg_per_s: }        optional
///         rotor: {inertia_kg_m2: }                                                      optional
///     flange: {position_mm: , rpy_deg: }                            in the last link
///     sources: {geometry: , limits: , acceleration: , masses: }     masses if there are any
///
/// or with a section `ortho_parallel` of a1_mm, a2_mm, b_mm, c1_mm … c4_mm instead of origins, axes and
/// flange; its six joints have offset_deg, reversed and limits. A torque that is not published is left out.
/// @throws ConfigError with file, line, key, what was found and what is accepted.
[[nodiscard]] RobotModel LoadRobot(const std::filesystem::path& path);

/// Reads a section with mass_kg, center_mm and inertia_kg_m2 (about the centre: xx, yy, zz, xy, xz, yz). The
/// caller may read further keys of the section before it calls Finish() of the file.
[[nodiscard]] kinematics::LinkInertia ReadBody(Reader section);

/// Refuses a body that is physically impossible, at its section. Call after Finish().
/// @param name  of the body, for the error
void CheckBody(const Reader& section, const kinematics::LinkInertia& body, const std::string& name);

}  // namespace osteon::config
