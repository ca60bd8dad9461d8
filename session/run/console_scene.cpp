#include "session/run/console_scene.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>
#include <system_error>
#include <variant>

#include <nlohmann/json.hpp>

#include "console/stream/live_json.h"
#include "control/setup/servo_params.h"
#include "safety/depth_limit.h"
#include "session/summary/limit_rows.h"
#include "simulation/removal/cut_metrics.h"

namespace osteon::session {
namespace {

using nlohmann::json;

json Row(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

// Makes a list of the twelve numbers of [R | p], row by row.
json Rows(const Pose& X) {
  json numbers = json::array();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) numbers.push_back(X(row, column));
  return numbers;
}

// Makes the list of the arm's joints from base to flange.
template <int N>
json Chain(const kinematics::ChainParams<N>& chain) {
  json joints = json::array();
  for (const kinematics::RevoluteJoint& joint : chain.joints)
    joints.push_back({{"X_PJ", Rows(joint.X_PJ)}, {"axis", Row(joint.axis_J)}});
  return {{"joints", joints}, {"X_LF", Rows(chain.X_LF)}};
}

json Balls(const simulation::Tool& tool) {
  json balls = json::array();  // [x, y, z, radius, cutting]
  for (const simulation::ToolBall& ball : tool.balls)
    balls.push_back({ball.center_m.x, ball.center_m.y, ball.center_m.z, ball.radius_m, ball.cutting ? 1 : 0});
  return balls;
}

json Tool(const config::ToolConfig& tool) {
  return {{"name", tool.tool.name}, {"balls", Balls(tool.tool)}, {"X_FT", Rows(tool.X_FT)}};
}

// Makes the list of the workspace's sphere and zones.
json Zones(const safety::WorkspaceParams& workspace) {
  constexpr std::array<const char*, 5> kShapes{"half_space", "sphere", "box", "cylinder", "capsule"};
  constexpr std::array<const char*, 3> kPoints{"apex", "flange", "elbow"};
  json zones = json::array();
  zones.push_back({{"shape", "sphere"},
                   {"point", "apex"},
                   {"keep_in", true},
                   {"p", Row(workspace.sphere_center_W_m)},
                   {"radius_m", workspace.sphere_radius_m}});
  for (const safety::ZoneParams& zone : workspace.zones) {
    Pose X_WZ = Pose::Identity();
    X_WZ.linear() = zone.R_W;
    X_WZ.translation() = zone.p_W_m;
    zones.push_back({{"shape", kShapes.at(static_cast<std::size_t>(zone.shape))},
                     {"point", kPoints.at(static_cast<std::size_t>(zone.point))},
                     {"keep_in", zone.side == safety::ZoneSide::kKeepIn},
                     {"X", Rows(X_WZ)},
                     {"half_edge_m", Row(zone.half_edge_m)},
                     {"radius_m", zone.radius_m},
                     {"half_length_m", zone.half_length_m}});
  }
  return zones;
}

// Finds a limit that is present, by its name.
const EffectiveLimit& LimitOf(const std::vector<EffectiveLimit>& limits, std::string_view name) {
  return *std::ranges::find(limits, name, &EffectiveLimit::name);
}

// Makes a function that returns the distance left to the depth limit, as the loop measures it. If the limit
// moves with the bone, it is measured from the head of the bent tool.
std::function<double(const control::TickRecord&)> DepthLeft(const safety::DepthLimitParams& params) {
  if (!params.acts) return {};
  return [bound = safety::ZoneOf(params),
          moves_with_bone = params.rides_on_bone](const control::TickRecord& tick) {
    const bool use_bent_head = moves_with_bone && tick.compliance.present;
    const Pose X(use_bent_head ? tick.compliance.X_ME : tick.X_WT_cmd);
    return safety::ZoneBounds(bound, X.translation()).distance_m();
  };
}

}  // namespace

std::string ConsoleScene(const CellSetup& setup, const std::string& command, double seconds,
                         const std::string& recording, std::span<const simulation::Tool> tools) {
  const config::CellConfig& cell = setup.config;
  const simulation::CutSite& site = setup.bone.site;
  json materials = json::array();
  // a bone that was not packed has no materials yet
  for (const simulation::Material& material :
       setup.bone.materials.empty() ? setup.config.scene.materials : setup.bone.materials)
    materials.push_back(material.name);
  json each_tool = json::array();
  for (const simulation::Tool& tool : tools) each_tool.push_back(Balls(tool));
  const json scene{
      {"type", "hello"},
      {"schema", "osteon.scene/1"},
      {"version", OSTEON_VERSION},
      {"command", command},
      {"cell", setup.cell_name},
      {"scene", setup.bone.name},
      {"seconds", seconds},
      {"recording", recording},
      {"force_limit_N", control::ForceLimit_N(cell.servo)},
      {"speed_limit_mm_per_s", 1e3 * cell.servo.twist.max_speed_m_per_s},
      {"law", cell.servo.law == control::Law::kAdmittance ? "admittance" : "impedance"},
      {"period_s", cell.servo.period_s},
      {"fields", console::kStripFields},
      {"X_WB", Rows(cell.X_WB)},
      {"X_WG", Rows(setup.X_WG)},
      {"site", {{"center", Row(site.center_m)}, {"axis", Row(site.axis)}, {"radius_m", site.radius_m}}},
      {"materials", materials},
      {"tool", Tool(cell.tool)},
      {"tools", each_tool},
      {"arm", std::visit([](const auto& arm) { return Chain(arm.chain); }, cell.robot.arm)},
      {"arm_name", cell.robot.name},
      {"zones", Zones(cell.servo.workspace)}};
  return scene.dump(-1, ' ', false, json::error_handler_t::replace);
}

console::LiveContext LiveContextOf(const CellSetup& setup) {
  const control::ServoParams& servo = setup.config.servo;
  const std::vector<EffectiveLimit> limits = EffectiveLimits(servo);
  const std::string& from = LimitOf(limits, "force").from;
  console::LiveContext context{
      .force_limit_N = control::ForceLimit_N(servo),
      .force_limit_from = from.substr(0, from.find(';')),
      .torque_limit_Nm = LimitOf(limits, "torque").value,
      .axis_W = PlainVector3((setup.X_WG.linear() * Vector3(setup.bone.site.axis)).normalized()),
      .has_plc = servo.has_interlock,
      .depth_left_m = DepthLeft(servo.depth)};
  if (setup.bone.balls.empty()) return context;
  const simulation::ApexDepth depth(setup.bone, setup.config.tool.tool);
  context.depth_m = [depth, X_GW = Pose(setup.X_WG.inverse())](const Pose& X_WP) {
    return depth.DepthAt(X_GW * X_WP);
  };
  return context;
}

std::filesystem::path ConsolePageFolder() {
  if (const char* folder = std::getenv("OSTEON_CONSOLE")) return folder;
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  for (const std::filesystem::path& folder :
       {program.parent_path() / "console" / "web", program.parent_path() / "share" / "osteon" / "console"})
    if (std::filesystem::exists(folder / "index.html", error)) return folder;
  return program.parent_path() / "console" / "web";
}

}  // namespace osteon::session
