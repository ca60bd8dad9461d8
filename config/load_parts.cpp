#include <array>

#include <fmt/format.h>

#include "config/load.h"

namespace osteon::config {

kinematics::LbrParams LoadRobot(const std::filesystem::path& path) {
  Reader reader = Reader::Load(path);
  kinematics::LbrParams params;

  Reader geometry = reader.Section("geometry");
  params.base_to_shoulder_m = geometry.Number("base_to_shoulder_mm", 100, 1000);
  params.shoulder_to_elbow_m = geometry.Number("shoulder_to_elbow_mm", 100, 1000);
  params.elbow_to_wrist_m = geometry.Number("elbow_to_wrist_mm", 100, 1000);
  params.wrist_to_flange_m = geometry.Number("wrist_to_flange_mm", 10, 500);
  static_cast<void>(
      geometry.Text("source"));  // a figure without a source is refused; the text is for the file's reader

  std::vector<Reader> joints = reader.Sections("joints", params.limits.size(), params.limits.size());
  static_cast<void>(reader.Text("joints_source"));
  std::array<std::string, 7> names;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    names[i] = joints[i].Text("name");
    kinematics::JointLimits& limit = params.limits[i];
    limit.upper_rad = joints[i].Number("position_deg", 1, 179);
    limit.lower_rad = -limit.upper_rad;
    limit.velocity_rad_per_s = joints[i].Number("velocity_deg_per_s", 1, 360);
    limit.acceleration_rad_per_s2 = joints[i].Number("acceleration_rad_per_s2", 0.1, 100);
    limit.torque_Nm = joints[i].Number("torque_Nm", 1, 1000);
  }
  reader.Finish();
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (names[i] != fmt::format("A{}", i + 1))
      joints[i].Refuse("name",
                       fmt::format("found {}, accepted A{}: the joints from the base on", names[i], i + 1));
  return params;
}

}  // namespace osteon::config
