#include "session/foxglove/cell_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "report/bone_shape.h"

namespace osteon::session {
namespace {

// The arm is drawn as simple bodies, not with the manufacturer's meshes. The console's page draws the same
// bodies.
constexpr double kBodyRadius_m = 0.055, kJointRadius_m = 0.068, kRodRadius_m = 0.008;
constexpr io::SceneColor kBody{.r = 0.79, .g = 0.81, .b = 0.84};
constexpr io::SceneColor kJoint{.r = 0.85, .g = 0.51, .b = 0.17};
constexpr io::SceneColor kCutting{.r = 0.55, .g = 0.58, .b = 0.62}, kShaft{.r = 0.38, .g = 0.41, .b = 0.46};
constexpr io::SceneColor kForce{.r = 0.80, .g = 0.10, .b = 0.10}, kHand{.r = 0.10, .g = 0.35, .b = 0.80};
constexpr io::SceneColor kPlane{.r = 0.95, .g = 0.75, .b = 0.10, .a = 0.5};
constexpr io::SceneColor kZone{.r = 0.80, .g = 0.10, .b = 0.10, .a = 0.15};
constexpr double kProxyOpacity = 0.35;  // opacity of the tool that is drawn in the frame `proxy`

constexpr double kArrow_m_per_N = 1e-3, kArrowDiameter_m = 4e-3;
constexpr double kMinForce_N = 0.5;  // no arrow is drawn for a smaller force
// Size of the plates that show contact planes.
constexpr double kPlaneEdge_m = 0.02, kPlaneThickness_m = 4e-4;
constexpr std::size_t kMaxBalls = 2000;  // at most this many balls of a tool are drawn

io::SceneColor ColorOf(const Vector3& rgb) { return {.r = rgb.x(), .g = rgb.y(), .b = rgb.z()}; }

// Returns the colour with its opacity multiplied by `opacity`.
io::SceneColor Faded(io::SceneColor color, double opacity) {
  color.a *= opacity;
  return color;
}

// Returns the colour of a cut face: the tissue's colour, shifted towards red.
io::SceneColor CutFace(const io::SceneColor& tissue) {
  constexpr double kShare = 0.45;  // share of red in the mixture
  return {.r = (1.0 - kShare) * tissue.r + kShare * 0.75,
          .g = (1.0 - kShare) * tissue.g + kShare * 0.20,
          .b = (1.0 - kShare) * tissue.b + kShare * 0.15};
}

// Draws a zone in the world; empty for a half-space. @param number  number of the zone, for the body's id
io::SceneEntity ZoneBody(const safety::ZoneParams& zone, std::size_t number) {
  io::SceneEntity entity{.id = fmt::format("zone_{}", number), .frame = "world"};
  Pose X_WZ = Pose::Identity();
  X_WZ.linear() = zone.R_W;
  X_WZ.translation() = zone.p_W_m;
  const Vector3 end = zone.half_length_m * zone.R_W.col(2);
  switch (zone.shape) {
    case safety::ZoneShape::kSphere:
      entity.balls.push_back({.center_m = zone.p_W_m, .radius_m = zone.radius_m, .color = kZone});
      break;
    case safety::ZoneShape::kBox:
      entity.boxes.push_back({.X_FB = X_WZ, .edges_m = 2.0 * zone.half_edge_m, .color = kZone});
      break;
    case safety::ZoneShape::kCapsule:
    case safety::ZoneShape::kCylinder:
      entity.rods.push_back(
          {.from_m = zone.p_W_m - end, .to_m = zone.p_W_m + end, .radius_m = zone.radius_m, .color = kZone});
      break;
    case safety::ZoneShape::kHalfSpace:  // infinite: not drawn
      break;
  }
  return entity;
}

}  // namespace

CellScene::DrawnTool CellScene::Draw(const simulation::Tool& tool, const Pose& X_FT) {
  DrawnTool drawn{.balls = {}, .p_TF = X_FT.inverse().translation()};
  for (std::size_t i = 0; i < std::min(tool.balls.size(), kMaxBalls); ++i) {
    const simulation::ToolBall& ball = tool.balls[i];
    drawn.balls.push_back({.center_m = {ball.center_m.x, ball.center_m.y, ball.center_m.z},
                           .radius_m = ball.radius_m,
                           .color = ball.cutting ? kCutting : kShaft});
  }
  return drawn;
}

CellScene::CellScene(const CellSetup& setup, std::span<const ProcedureTool> tools)
    : X_WB_(setup.config.X_WB), X_WG_(setup.X_WG) {
  std::visit(
      [this](const auto& arm) {
        for (const kinematics::RevoluteJoint& joint : arm.chain.joints)
          links_.push_back({.X_PJ = joint.X_PJ, .axis_J = joint.axis_J});
        X_LF_ = arm.chain.X_LF;
      },
      setup.config.robot.arm);
  for (const ProcedureTool& tool : tools) tools_.push_back(Draw(tool.tool, tool.loop.X_FT));
  if (tools_.empty()) tools_.push_back(Draw(setup.config.tool.tool, setup.config.tool.X_FT));
  for (const safety::ZoneParams& zone : setup.config.servo.workspace.zones)
    if (zone.side == safety::ZoneSide::kKeepOut) zones_.push_back(zone);
  for (std::size_t i = 0; i < setup.bone.materials.size(); ++i)
    tissues_.push_back(ColorOf(report::MaterialColor(setup.bone, static_cast<simulation::MaterialIndex>(i))));
}

std::vector<io::FramePlace> CellScene::Frames(const control::TickRecord& tick,
                                              const simulation::ContactModel& model) const {
  std::vector<io::FramePlace> frames{
      {.parent = "world", .child = "base", .X_PC = X_WB_},
      {.parent = "world", .child = "bone", .X_PC = X_WG_},
      {.parent = "world", .child = "tool", .X_PC = Pose(tick.X_WT_cmd)},
      {.parent = "world", .child = "tool_measured", .X_PC = Pose(tick.X_WT_meas)}};
  if (model.frame > 0) frames.push_back({.parent = "world", .child = "proxy", .X_PC = Pose(model.X_WP)});
  std::string parent = "base";
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const std::string child = fmt::format("link_{}", i + 1);
    const Pose turned(Eigen::AngleAxisd(tick.q_meas[i], links_[i].axis_J));
    frames.push_back({.parent = parent, .child = child, .X_PC = links_[i].X_PJ * turned});
    parent = child;
  }
  frames.push_back({.parent = parent, .child = "flange", .X_PC = X_LF_});
  return frames;
}

io::SceneEntity CellScene::BodyOf(const DrawnTool& tool, const char* frame, double opacity) {
  io::SceneEntity entity{.id = frame, .frame = frame, .balls = tool.balls};
  for (io::SceneBall& ball : entity.balls) ball.color = Faded(ball.color, opacity);
  entity.rods.push_back(
      {.from_m = tool.balls.empty() ? Vector3(Vector3::Zero()) : tool.balls.front().center_m,
       .to_m = tool.p_TF,
       .radius_m = kRodRadius_m,
       .color = Faded(kShaft, opacity)});
  return entity;
}

std::vector<io::SceneEntity> CellScene::Tools(std::size_t tool) const {
  const DrawnTool& drawn = tools_[std::min(tool, tools_.size() - 1)];
  return {BodyOf(drawn, "tool", 1.0), BodyOf(drawn, "proxy", kProxyOpacity)};
}

std::vector<io::SceneEntity> CellScene::Bodies(std::size_t tool) const {
  std::vector<io::SceneEntity> bodies = Tools(tool);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Vector3 next = i + 1 < links_.size() ? links_[i + 1].X_PJ.translation() : X_LF_.translation();
    io::SceneEntity link{.id = fmt::format("link_{}", i + 1), .frame = fmt::format("link_{}", i + 1)};
    link.rods.push_back({.from_m = Vector3::Zero(), .to_m = next, .radius_m = kBodyRadius_m, .color = kBody});
    const Vector3 half = 0.75 * kJointRadius_m * links_[i].axis_J;
    link.rods.push_back({.from_m = -half, .to_m = half, .radius_m = kJointRadius_m, .color = kJoint});
    bodies.push_back(std::move(link));
  }
  for (std::size_t i = 0; i < zones_.size(); ++i) bodies.push_back(ZoneBody(zones_[i], i + 1));
  return bodies;
}

std::vector<io::SceneEntity> CellScene::Forces(const control::TickRecord& tick,
                                               const simulation::ContactModel& model) const {
  std::vector<io::SceneEntity> entities;
  const auto arrow = [&](const char* id, const PlainVector3& force, const io::SceneColor& color) {
    const Vector3 F(force.x, force.y, force.z);
    if (F.norm() < kMinForce_N) return;
    io::SceneEntity entity{.id = id, .frame = "world"};
    entity.arrows.push_back({.from_m = {tick.X_WT_cmd.p.x, tick.X_WT_cmd.p.y, tick.X_WT_cmd.p.z},
                             .along_m = kArrow_m_per_N * F,
                             .diameter_m = kArrowDiameter_m,
                             .color = color});
    entities.push_back(std::move(entity));
  };
  arrow("coupling_force", tick.F_coupling_T_W.f, kForce);
  arrow("hand_force", tick.F_operator_T_W.f, kHand);
  io::SceneEntity planes{.id = "planes", .frame = "world"};
  for (std::int32_t i = 0; i < model.contact_count; ++i) {
    const simulation::Contact& contact = model.contacts[static_cast<std::size_t>(i)];
    const Vector3 n(contact.n_W.x, contact.n_W.y, contact.n_W.z);
    if (!(n.norm() > 0.0)) continue;
    Pose X = Pose::Identity();
    X.translation() = Vector3(contact.p_W_m.x, contact.p_W_m.y, contact.p_W_m.z);
    X.linear() = RotationFromZTo(n);
    planes.boxes.push_back(
        {.X_FB = X, .edges_m = {kPlaneEdge_m, kPlaneEdge_m, kPlaneThickness_m}, .color = kPlane});
  }
  entities.push_back(std::move(planes));
  return entities;
}

io::SceneEntity CellScene::BonePart(const std::string& id,
                                    std::span<const surface::SurfaceChunk> chunks) const {
  io::SceneEntity entity{.id = id, .frame = "bone"};
  io::SceneMesh& mesh = entity.mesh;
  for (const surface::SurfaceChunk& chunk : chunks) {
    const auto first = static_cast<std::uint32_t>(mesh.points_m.size());
    for (const surface::SurfaceVertex& vertex : chunk.vertices) {
      mesh.points_m.push_back(1e-3 * Vector3(vertex.p_mm.x, vertex.p_mm.y, vertex.p_mm.z));
      const io::SceneColor tissue = vertex.material < tissues_.size()
                                        ? tissues_[vertex.material]
                                        : io::SceneColor{.r = 0.9, .g = 0.85, .b = 0.75};
      mesh.colors.push_back(vertex.cut ? CutFace(tissue) : tissue);
    }
    for (std::size_t i = 0; i + 3 < chunk.quads.size(); i += 4)
      for (const std::size_t corner : {0U, 1U, 2U, 0U, 2U, 3U})
        mesh.triangles.push_back(first + chunk.quads[i + corner]);
  }
  return entity;
}

}  // namespace osteon::session
