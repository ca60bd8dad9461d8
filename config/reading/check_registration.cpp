#include "config/reading/check_registration.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "base/units.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/ortho_parallel_arm.h"
#include "kinematics/serial_chain.h"
#include "safety/workspace.h"

namespace osteon::config {
namespace {

constexpr double kFoot_mm = 150.0;         // half of an arm's foot plus half of a small bone
constexpr double kLongestTool_mm = 600.0;  // largest distance from the flange to the apex
constexpr double kInMetres_mm = 5.0;       // a position nearer to the origin is probably written in metres
constexpr double kSteepest_deg = 60.0;     // largest angle between the tool's axis and the site's axis
constexpr double kUpright_deg = 0.1;  // a smaller tilt of the base is not noted: it is an error of levelling
constexpr double kRotation = 1e-6;    // largest norm of R R^T - 1 for a rotation matrix R
constexpr const char* kLooksLikeMetres = "looks like metres where millimetres are expected";

double AngleBetween_deg(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kDegree;
}

// Radius [m] of the ball around the site that contains the work: the site's radius plus the depth of the cut.
double WorkRadius(const CellConfig& cell) {
  const simulation::SceneParams& scene = cell.scene;
  const simulation::CutSite* mesh_cup = cell.bone && cell.bone->cup ? &*cell.bone->cup : nullptr;
  if (const auto* cup = std::get_if<simulation::AcetabulumShape>(&scene.shape))
    return 2.0 * (mesh_cup ? mesh_cup->radius_m : cup->cup_radius_m);
  double depth_m = 0.0;
  for (const Vector3& p_C : scene.zone.path_C_m) depth_m = std::max(depth_m, -p_C.z());
  return (mesh_cup ? mesh_cup->radius_m : scene.site.radius_m) + depth_m;
}

// The shoulder, and the largest distance of the flange from the shoulder.
struct Reach {
  Vector3 p_BS{Vector3::Zero()};  // the shoulder, on A1
  double reach_m{0.0};
};

Reach ReachOf(const LbrConfig& arm) {
  const kinematics::LbrParams& p = arm.params;
  return {.p_BS = {0.0, 0.0, p.base_to_shoulder_m},
          .reach_m = p.shoulder_to_elbow_m + p.elbow_to_wrist_m + std::abs(p.wrist_to_flange_m)};
}

Reach ReachOf(const SixAxisConfig& arm) {
  const kinematics::OrthoParallelParams& p = arm.params;
  return {.p_BS = {0.0, 0.0, p.c1_m},
          .reach_m = std::hypot(p.a1_m, p.b_m) + p.c2_m + std::hypot(p.a2_m, p.c3_m) + std::abs(p.c4_m)};
}

// X_BF, the flange in the base, at joint angles q [rad].
Pose FlangePose(const LbrConfig& arm, const kinematics::JointVector& q) {
  return kinematics::SerialChain<7>(arm.chain).FlangePose(q);
}

Pose FlangePose(const SixAxisConfig& arm, const kinematics::JointVector& q) {
  return kinematics::SerialChain<6>(arm.chain).FlangePose(q.head<6>());
}

// p_BElbow, the elbow in the base, at joint angles q [rad].
Vector3 ElbowPosition(const LbrConfig& arm, const kinematics::JointVector& q) {
  return kinematics::LbrArm(arm.params).Points(q).p_BElbow;
}

Vector3 ElbowPosition(const SixAxisConfig& arm, const kinematics::JointVector& q) {
  return kinematics::OrthoParallelArm(arm.params).Points(q.head<6>()).p_BElbow;
}

// The rows of base, bone, tool and workspace, which need no solution for the arm's joints.
std::vector<RegistrationRow> FrameRows(const CellConfig& cell) {
  const Vector3 p_WB = cell.X_WB.translation(), p_WC = cell.X_WG.translation(),
                p_FT = cell.tool.X_FT.translation();
  const Reach arm = std::visit([](const auto& a) { return ReachOf(a); }, cell.robot.arm);
  const double from_base_mm = (p_WC - p_WB).norm() / kMillimetre_m;
  const Vector3 p_WS = cell.X_WB * arm.p_BS;
  const double reach_m = arm.reach_m + p_FT.norm();
  const Matrix3 R_FT = cell.tool.X_FT.linear();
  const double tilt_deg = AngleBetween_deg(cell.X_WB.linear().col(2), Vector3::UnitZ());
  const safety::WorkspaceParams& workspace = cell.servo.workspace;
  const double center_mm = workspace.sphere_center_W_m.norm() / kMillimetre_m;
  const bool sphere_in_metres = center_mm > 0.0 && center_mm < kInMetres_mm;
  const double to_sphere_m = workspace.sphere_radius_m - (p_WC - workspace.sphere_center_W_m).norm(),
               to_plane_m = workspace.plane_normal_W.dot(p_WC) - workspace.plane_offset_m;
  const double work_mm = WorkRadius(cell) / kMillimetre_m;

  return {
      {.name = "from the arm's base to the site",
       .value = from_base_mm,
       .unit = "mm",
       .low = kFoot_mm,
       .section = "bone_in_world",
       .key = "position_mm",
       .hint = from_base_mm < kInMetres_mm ? kLooksLikeMetres : "the bone would be in the arm's foot",
       .note = {}},
      {.name = "from the arm's shoulder to the site",
       .value = (p_WC - p_WS).norm() / kMillimetre_m,
       .unit = "mm",
       .high = reach_m / kMillimetre_m,
       .section = "bone_in_world",
       .key = "position_mm",
       .hint = "out of the stretched arm's reach; base_in_world says where the arm stands",
       .note = {}},
      {.name = "from the flange to the tool's apex",
       .value = p_FT.norm() / kMillimetre_m,
       .unit = "mm",
       .high = kLongestTool_mm,
       .section = {},
       .key = "tool",
       .hint = cell.tool.tool.name + ": its mounting's position_mm and its length",
       .note = {}},
      {.name = "from the tool's rotation to the nearest rotation",
       // A mirror image is no rotation: it gets the value 2, which is above the limit.
       .value = R_FT.determinant() > 0.0 ? (R_FT * R_FT.transpose() - Matrix3::Identity()).norm() : 2.0,
       .unit = "",
       .high = kRotation,
       .section = {},
       .key = "tool",
       .hint = cell.tool.tool.name + ": its mounting's rpy_deg",
       .note = {}},
      {.name = "from the site to the workspace's sphere",
       .value = to_sphere_m / kMillimetre_m,
       .unit = "mm",
       .low = work_mm,
       .section = to_sphere_m < 0.0 && !sphere_in_metres ? "bone_in_world" : "workspace",
       .key = to_sphere_m < 0.0 && !sphere_in_metres ? "position_mm" : "sphere_center_mm",
       .hint = sphere_in_metres    ? kLooksLikeMetres
               : to_sphere_m < 0.0 ? "the site is outside of the workspace"
                                   : "the site with its depth must be inside",
       .note = {}},
      {.name = "from the site to the workspace's plane",
       .value = to_plane_m / kMillimetre_m,
       .unit = "mm",
       .low = work_mm,
       .section = to_plane_m < 0.0 ? "bone_in_world" : "workspace",
       .key = to_plane_m < 0.0 ? "position_mm" : "plane_offset_mm",
       .hint = to_plane_m < 0.0 ? "the site is below the workspace's plane"
                                : "the site with its depth must be above",
       .note = {}},
      {.name = "from the arm's base to the vertical",
       .value = tilt_deg,
       .unit = "deg",
       .section = "base_in_world",
       .key = "rpy_deg",
       .hint = {},
       .note = tilt_deg > kUpright_deg ? "the arm's own controller must know how it is mounted" : ""},
  };
}

// The rows of the start: joints, apex, tool axis, flange and elbow, by forward kinematics from cell.start.q.
std::vector<RegistrationRow> StartRows(const CellConfig& cell) {
  const Pose X_BF =
      std::visit([&](const auto& arm) { return FlangePose(arm, cell.start.q); }, cell.robot.arm);
  const Pose X_WF = cell.X_WB * X_BF, X_WT = X_WF * cell.tool.X_FT;
  const safety::WorkspaceParams& workspace = cell.servo.workspace;
  double margin_rad = std::numeric_limits<double>::infinity();
  int nearest = 0;  // number of the joint that is nearest to a limit
  for (int i = 0; i < (cell.robot.lbr() ? 7 : 6); ++i) {
    const kinematics::JointLimits& limits = cell.servo.joints.limits[static_cast<std::size_t>(i)];
    const double room_rad = std::min(cell.start.q[i] - limits.lower_rad, limits.upper_rad - cell.start.q[i]);
    if (room_rad < margin_rad) nearest = i + 1;
    margin_rad = std::min(margin_rad, room_rad);
  }
  const double flange_m = workspace.plane_normal_W.dot(X_WF.translation()) - workspace.plane_offset_m;

  std::vector<RegistrationRow> rows{
      {.name = "from the joints at the start to their nearest limit",
       .value = margin_rad / kDegree,
       .unit = "deg",
       .low = cell.servo.joints.position_margin_rad / kDegree,
       .section = "start",
       .key = cell.robot.lbr() ? "arm_angle_deg" : "tool_yaw_deg",
       .hint = fmt::format("joint A{}; joint_margin_deg is to be kept", nearest),
       .note = {}},
      {.name = "from the apex at the start to the workspace's bounds",
       .value = safety::Workspace(workspace).Distance(X_WT.translation()) / kMillimetre_m,
       .unit = "mm",
       .low = 0.0,
       .section = "start",
       .key = "height_mm",
       .hint = {},
       .note = {}},
      {.name = "from the tool's axis at the start to the way into the bone",
       .value = AngleBetween_deg(X_WT.linear().col(2), -cell.X_WG.linear().col(2)),
       .unit = "deg",
       .high = kSteepest_deg,
       .section = "bone_in_world",
       .key = "rpy_deg",
       .hint = "+z of the site points out of the bone, +z of the tool along its feed",
       .note = {}},
      {.name = "from the flange at the start to the workspace's plane",
       .value = flange_m / kMillimetre_m,
       .unit = "mm",
       .low = 0.0,
       .section = "start",
       .key = "height_mm",
       .hint = "the arm would be beneath it",
       .note = {}},
  };
  if (const safety::DepthLimitParams& depth = cell.servo.depth; depth.acts)
    rows.push_back(
        {.name = "from the apex at the start to the depth limit's bound",
         .value = safety::ZoneBounds(safety::ZoneOf(depth), X_WT.translation()).distance_m() / kMillimetre_m,
         .unit = "mm",
         .low = 0.0,
         .section = "depth_limit",
         .key = "at_mm",
         .hint = "the tool would begin beyond it",
         .note = {}});
  const safety::Workspace bounds(workspace);
  const auto zone_row = [&](safety::ZonePoint point, const char* name, const Vector3& p_W) {
    if (!bounds.Has(point)) return;
    rows.push_back({.name = fmt::format("from the {} at the start to its zones' bounds", name),
                    .value = bounds.Distance(p_W, point) / kMillimetre_m,
                    .unit = "mm",
                    .low = 0.0,
                    .section = "start",
                    .key = "height_mm",
                    .hint = "zones that keep it in or out",
                    .note = {}});
  };
  zone_row(safety::ZonePoint::kFlange, "flange", X_WF.translation());
  zone_row(safety::ZonePoint::kElbow, "elbow",
           cell.X_WB *
               std::visit([&](const auto& arm) { return ElbowPosition(arm, cell.start.q); }, cell.robot.arm));
  return rows;
}

// Refuses a key of a section of the cell's file.
[[noreturn]] void RefuseIn(const Reader& reader, const char* section, const char* key,
                           const std::string& what) {
  Reader at = reader;  // used only to find the line of the key
  at.Section(section).Refuse(key, what);
}

// Whether a position was probably written in metres instead of millimetres: it is close to the origin, but
// not at it.
bool LooksLikeMetres(const Pose& X) {
  const double from_origin_mm = X.translation().norm() / kMillimetre_m;
  return from_origin_mm > 0.0 && from_origin_mm < kInMetres_mm;
}

// Refuses a position of the base that is probably written in metres: all rows hold if it is read as metres.
// The same mistake in the bone's position is found by the row "base to site", because the bone would lie in
// the arm's foot.
void RefuseBaseInMetres(const CellConfig& cell, const Reader& reader) {
  if (!LooksLikeMetres(cell.X_WB)) return;
  CellConfig in_millimetres = cell;
  in_millimetres.X_WB.translation() *= 1e3;
  const std::vector<RegistrationRow> rows = FrameRows(in_millimetres);
  if (!std::all_of(rows.begin(), rows.end(), [](const RegistrationRow& row) { return row.holds(); })) return;
  const Vector3 p = cell.X_WB.translation() / kMillimetre_m;
  RefuseIn(reader, "base_in_world", "position_mm",
           fmt::format("found ({:.6g}, {:.6g}, {:.6g}) mm, accepted millimetres: {}", p.x(), p.y(), p.z(),
                       kLooksLikeMetres));
}

// Refuses the first row that does not hold, at the key that is probably wrong.
void RefuseFailedRow(const std::vector<RegistrationRow>& rows, const Reader& reader) {
  for (const RegistrationRow& row : rows) {
    if (row.holds()) continue;
    Reader at = reader;  // used only to find the line of the key
    if (!row.section.empty()) at = at.Section(row.section);
    at.Refuse(row.key,
              fmt::format("found {:.6g}{}{} {}, accepted {}{}{}", row.value, row.unit.empty() ? "" : " ",
                          row.unit, row.name, row.accepted(), row.hint.empty() ? "" : ": ", row.hint));
  }
}

}  // namespace

std::string RegistrationRow::accepted() const {
  const std::string end = unit.empty() ? "" : " " + unit;
  if (std::isfinite(low) && std::isfinite(high)) return fmt::format("{:.6g} … {:.6g}{}", low, high, end);
  if (std::isfinite(low)) return fmt::format("at least {:.6g}{}", low, end);
  if (std::isfinite(high)) return fmt::format("at most {:.6g}{}", high, end);
  return "any";
}

std::string RegistrationRow::verdict() const {
  if (!holds()) return "refused: accepted " + accepted();
  return note.empty() ? "ok" : "note: " + note;
}

RegistrationReport DescribeRegistration(const CellConfig& cell) {
  RegistrationReport report{FrameRows(cell)};
  for (RegistrationRow& row : StartRows(cell)) report.rows.push_back(std::move(row));
  return report;
}

void CheckFrames(const CellConfig& cell, const Reader& reader) {
  const std::vector<RegistrationRow> rows = FrameRows(cell);
  if (std::any_of(rows.begin(), rows.end(), [](const RegistrationRow& row) { return !row.holds(); }))
    RefuseBaseInMetres(cell, reader);
  RefuseFailedRow(rows, reader);
}

void RefuseStart(const CellConfig& cell, const Reader& reader, const std::string& what,
                 const std::function<bool(CellConfig&)>& is_possible) {
  const auto possible_with = [&](const auto& change) {
    CellConfig other = cell;
    change(other);
    return is_possible(other);
  };
  for (const auto& place :
       {std::pair{&CellConfig::X_WB, "base_in_world"}, {&CellConfig::X_WG, "bone_in_world"}}) {
    const auto pose = place.first;
    const char* section = place.second;
    const Vector3 p = (cell.*pose).translation() / kMillimetre_m;
    // Is the start possible if this pose is read as metres?
    if (LooksLikeMetres(cell.*pose) &&
        possible_with([&](CellConfig& other) { (other.*pose).translation() *= 1e3; }))
      RefuseIn(reader, section, "position_mm",
               fmt::format("found ({:.6g}, {:.6g}, {:.6g}) mm, accepted millimetres: {} ({})", p.x(), p.y(),
                           p.z(), kLooksLikeMetres, what));
    const double tilt_deg = AngleBetween_deg((cell.*pose).linear().col(2), Vector3::UnitZ());
    if (tilt_deg <= 90.0) continue;
    // Is the start possible if this pose is turned over?
    for (const Vector3& axis : {Vector3(Vector3::UnitX()), Vector3(Vector3::UnitY())})
      if (possible_with([&](CellConfig& other) {
            (other.*pose).linear() = (other.*pose).linear() * Eigen::AngleAxisd(std::numbers::pi, axis);
          }))
        RefuseIn(
            reader, section, "rpy_deg",
            fmt::format("found {:.4g} deg from the vertical, accepted a pose from which the start can be "
                        "reached, such as this one turned over: {}",
                        tilt_deg, what));
  }
  if (possible_with([](CellConfig& other) { other.start.height_m = 0.0; }))
    RefuseIn(reader, "start", "height_mm", what + "; nearer to the site it would not be so");
  const Reach arm = std::visit([](const auto& a) { return ReachOf(a); }, cell.robot.arm);
  const Pose X_WF = cell.start.X_WT * cell.tool.X_FT.inverse();
  const double away_m = (X_WF.translation() - cell.X_WB * arm.p_BS).norm();
  if (away_m > arm.reach_m)
    RefuseIn(
        reader, "bone_in_world", "position_mm",
        fmt::format("found {:.6g} mm from the arm's shoulder to its flange at the start, accepted at most "
                    "{:.6g} mm: out of the stretched arm's reach; base_in_world says where the arm stands",
                    away_m / kMillimetre_m, arm.reach_m / kMillimetre_m));
  RefuseIn(reader, "start", "height_mm", what);
}

void CheckStart(const CellConfig& cell, const Reader& reader) { RefuseFailedRow(StartRows(cell), reader); }

}  // namespace osteon::config
