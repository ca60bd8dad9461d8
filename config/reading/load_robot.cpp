#include "config/reading/load_robot.h"

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/units.h"
#include "config/reading/sections/read_pose.h"
#include "kinematics/check_chain.h"

namespace osteon::config {
namespace {

using kinematics::ChainParams;
using kinematics::JointLimits;
using kinematics::LinkInertia;
using kinematics::OrthoParallelParams;
using kinematics::RevoluteJoint;

constexpr double kTurn_deg = 360.0;

JointLimits ReadLimits(Reader section) {
  JointLimits limits;
  limits.lower_rad = section.Number("lower_deg", -kTurn_deg, kTurn_deg);
  limits.upper_rad = section.Number("upper_deg", -kTurn_deg, kTurn_deg);
  limits.velocity_rad_per_s = section.Number("velocity_deg_per_s", 1, 1000);
  limits.acceleration_rad_per_s2 = section.Number("acceleration_rad_per_s2", 0.1, 1000);
  if (section.Has("torque_Nm")) limits.torque_Nm = section.Number("torque_Nm", 1, 10'000);
  return limits;
}

// One joint of a file: its name and its sections.
struct JointSections {
  Reader joint, limits;
  std::string name;
};

JointSections ReadNameAndLimits(Reader& row, JointLimits& limits) {
  std::string name = row.Text("name");
  Reader section = row.Section("limits");
  limits = ReadLimits(section);
  return {row, section, std::move(name)};
}

void CheckNameAndLimits(const JointSections& sections, std::size_t i, const JointLimits& limits) {
  if (const std::string expected = fmt::format("A{}", i + 1); sections.name != expected)
    sections.joint.Refuse(
        "name", fmt::format("found {}, accepted {}: the joints from the base on", sections.name, expected));
  if (!(limits.lower_rad < limits.upper_rad))
    sections.limits.Refuse("upper_deg", fmt::format("found {:.10g}, accepted more than lower_deg ({:.10g})",
                                                    limits.upper_rad / kDegree, limits.lower_rad / kDegree));
}

// A joint of a file that describes the arm joint by joint.
struct JointRow {
  RevoluteJoint joint;
  JointSections sections;
  std::optional<Reader> link;  // the section with the link's mass, if it has one
};

JointRow ReadJoint(Reader row) {
  RevoluteJoint joint;
  JointSections sections = ReadNameAndLimits(row, joint.limits);
  joint.X_PJ = ReadPose(row.Section("origin"));
  joint.axis_J = row.Direction("axis");
  std::optional<Reader> link;
  if (row.Has("link")) {
    link = row.Section("link");
    joint.link = ReadBody(*link);
  }
  if (row.Has("friction")) {
    Reader friction = row.Section("friction");
    joint.friction.viscous_Nms_per_rad = friction.Number("viscous_Nms_per_rad", 0, 1000);
    joint.friction.coulomb_Nm = friction.Number("coulomb_Nm", 0, 1000);
    joint.friction.smoothing_rad_per_s = friction.Number("smoothing_deg_per_s", 1e-3, 100);
  }
  if (row.Has("rotor")) joint.rotor_inertia_kg_m2 = row.Section("rotor").Number("inertia_kg_m2", 0, 100);
  return {joint, sections, link};
}

// Makes a chain from the joints and X_LF, the flange's pose in the last link.
template <int N>
ChainParams<N> ChainOf(const std::vector<JointRow>& rows, const Pose& X_LF) {
  ChainParams<N> chain;
  for (std::size_t i = 0; i < N; ++i) chain.joints[i] = rows[i].joint;
  chain.X_LF = X_LF;
  chain.has_masses = rows.front().link.has_value();
  return chain;
}

// Reads the form joint by joint.
void ReadJoints(Reader& reader, RobotModel& model) {
  std::vector<JointRow> rows;
  for (const Reader& row : reader.Sections("joints", 6, 7)) rows.push_back(ReadJoint(row));
  const Pose X_LF = ReadPose(reader.Section("flange"));
  // The file must name its sources; the program does not use them. A source of masses must be present if, and
  // only if, the links have masses.
  Reader sources = reader.Section("sources");
  for (const char* figure : {"geometry", "limits", "acceleration"}) static_cast<void>(sources.Text(figure));
  const bool has_masses = sources.Has("masses");
  if (has_masses) static_cast<void>(sources.Text("masses"));
  reader.Finish();

  for (std::size_t i = 0; i < rows.size(); ++i) {
    const JointRow& row = rows[i];
    CheckNameAndLimits(row.sections, i, row.joint.limits);
    if (row.link.has_value() != has_masses)
      row.sections.joint.Refuse(
          "name", has_masses
                      ? fmt::format("found {} without a link, accepted one with: sources names masses",
                                    row.sections.name)
                      : fmt::format("found {} with a link, accepted one without: sources names no masses",
                                    row.sections.name));
    if (row.link) CheckBody(*row.link, row.joint.link, row.sections.name);
  }
  if (rows.size() == 7)
    model.chain = ChainOf<7>(rows, X_LF);
  else if (rows.size() == 6)
    model.chain = ChainOf<6>(rows, X_LF);
}

// Reads the form with the lengths of an ortho-parallel arm.
void ReadOrthoParallel(Reader& reader, RobotModel& model) {
  OrthoParallelParams params;
  Reader lengths = reader.Section("ortho_parallel");
  for (const auto& [key, value] :
       {std::pair{"a1_mm", &params.a1_m}, std::pair{"a2_mm", &params.a2_m}, std::pair{"b_mm", &params.b_m}})
    *value = lengths.Number(key, -5000, 5000);
  for (const auto& [key, value] : {std::pair{"c1_mm", &params.c1_m}, std::pair{"c4_mm", &params.c4_m}})
    *value = lengths.Number(key, 0, 5000);
  for (const auto& [key, value] : {std::pair{"c2_mm", &params.c2_m}, std::pair{"c3_mm", &params.c3_m}})
    *value = lengths.Number(key, 1, 5000);
  std::vector<JointSections> joints;
  std::vector<Reader> rows = reader.Sections("joints", 6, 6);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    joints.push_back(ReadNameAndLimits(rows[i], params.limits[i]));
    params.offset_rad[i] = rows[i].Number("offset_deg", -180, 180);
    params.sign[i] = rows[i].Bool("reversed") ? -1.0 : 1.0;
  }
  Reader sources = reader.Section("sources");
  for (const char* figure : {"geometry", "limits", "acceleration"}) static_cast<void>(sources.Text(figure));
  reader.Finish();

  for (std::size_t i = 0; i < joints.size(); ++i) CheckNameAndLimits(joints[i], i, params.limits[i]);
  model.ortho_parallel = params;
  model.chain = kinematics::ChainFrom(params);
}

}  // namespace

LinkInertia ReadBody(Reader section) {
  LinkInertia body;
  body.mass_kg = section.Number("mass_kg", 0, 1000);
  body.p_LLcm_m = section.Triple("center_mm", -2000, 2000);
  const std::vector<double> I = section.Numbers("inertia_kg_m2", 6, -1000, 1000);
  body.I_LLcm_kg_m2 << I[0], I[3], I[4], I[3], I[1], I[5], I[4], I[5], I[2];
  return body;
}

void CheckBody(const Reader& section, const LinkInertia& body, const std::string& name) {
  try {
    kinematics::CheckInertia(body, name);
  } catch (const std::invalid_argument& error) {
    section.Refuse("inertia_kg_m2", error.what());
  }
}

RobotModel LoadRobot(const std::filesystem::path& path) {
  Reader reader = Reader::Load(path);
  RobotModel model;
  model.name = reader.Text("name");
  if (reader.Has("ortho_parallel"))
    ReadOrthoParallel(reader, model);
  else
    ReadJoints(reader, model);
  return model;
}

}  // namespace osteon::config
