#include "gpu/vulkan_engine.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "gpu/frame_program.h"
#include "simulation/cutting_math.h"
#include "simulation/frame_solution.h"

namespace osteon::gpu {
namespace {

using simulation::kMaxContacts;

static_assert(kMaxMaterials == static_cast<uint>(simulation::kMaxMaterials) && kPlanes == kMaxContacts &&
              kShaft == static_cast<uint>(simulation::kShaftPlane));

constexpr double kMillimetres = 1e3;
constexpr double kLargestSummand = 4'194'304.0;  // 2^22 units: half of what a sum over a subgroup can take
constexpr double kLargestLens_mm3 = simulation::kLargestLensVolume * 1e9;
// The servo loop stops on the model's age long before; this ends a wait for a device that hangs.
constexpr std::uint64_t kFrameTimeout_ns = 20'000'000'000;
constexpr std::uint64_t kWarmUpTimeout_ns =
    120'000'000'000;  // software drivers compile a pass when it first runs
// How far the tool may move before the lists of live balls and points are made anew. Balls that do not cut
// are mostly far from bone, so a wide margin costs nothing.
constexpr double kCuttingMargin_m = 0.15e-3, kShaftMargin_m = 3e-3;

vec4 ToMillimetres(const Vector3& v, double w) {
  return {static_cast<float>(v.x() * kMillimetres), static_cast<float>(v.y() * kMillimetres),
          static_cast<float>(v.z() * kMillimetres), static_cast<float>(w)};
}
vec4 Unscaled(const Vector3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0.0f};
}
Vector3 Direction(const vec4& v) { return {v.x, v.y, v.z}; }
Vector3 ToMetres(const vec4& v) { return Direction(v) / kMillimetres; }

// Boxes around runs of 64 items; an item is a centre and a radius [mm].
template <class Items, class Get>
std::vector<Cluster> Boxes(const Items& items, Get get) {
  std::vector<Cluster> boxes(ClusterCount(items.size()));
  for (std::size_t c = 0; c < boxes.size(); ++c) {
    Eigen::AlignedBox3f box;
    for (std::size_t i = c * kGroupSize; i < std::min(items.size(), (c + 1) * kGroupSize); ++i) {
      const vec4 item = get(items[i]);
      const Eigen::Vector3f p(item.x, item.y, item.z);
      box.extend(p - Eigen::Vector3f::Constant(item.w)).extend(p + Eigen::Vector3f::Constant(item.w));
    }
    boxes[c] = {.low_x = box.min().x(),
                .low_y = box.min().y(),
                .low_z = box.min().z(),
                .alive = static_cast<uint>(std::min<std::size_t>(kGroupSize, items.size() - c * kGroupSize)),
                .high_x = box.max().x(),
                .high_y = box.max().y(),
                .high_z = box.max().z(),
                .pad = 0};
  }
  return boxes;
}

}  // namespace

struct VulkanEngine::Impl : FrameProgram {
  simulation::Tool tool;
  std::vector<simulation::Material> materials;
  Pose X_WG;
  simulation::CuttingParams params;
  simulation::FrameMemory memory;
  double unit_mm3{1.0};
  bool lost{false};

  Frame still{};  // what does not change from frame to frame

  // the lists of live balls and points that lie on the device, as the last frame left them
  struct Lists {
    bool made{false};
    float ball_reach_mm{0.0f}, point_reach_mm{0.0f};
    Groups live_balls{0, 1, 1}, live_points{0, 1, 1}, shaft_balls{0, 1, 1};
    uint ball_count{0}, point_count{0};
    decltype(Frame::built) built{};
  } lists;

  void Upload(const simulation::Bone& bone);
  template <class Alive>
  void Recount(const Buffer& clusters, std::size_t count, Alive alive) const;
  bool WarmUp(const simulation::Bone& bone);
  Frame Prepare(const simulation::FrameInput& input) const;
  void KeepLists(const Frame& done);
  simulation::FrameSolution Solution(const Frame& done) const;
};

template <class Alive>
void VulkanEngine::Impl::Recount(const Buffer& clusters, std::size_t count, Alive alive) const {
  std::vector<Cluster> boxes(ClusterCount(count));
  Read(clusters, boxes.data(), boxes.size() * sizeof(Cluster));
  for (Cluster& box : boxes) box.alive = 0;
  for (std::size_t i = 0; i < count; ++i) boxes[i / kGroupSize].alive += alive(i) ? 1 : 0;
  Write(clusters, boxes.data(), boxes.size() * sizeof(Cluster));
}

void VulkanEngine::Impl::Upload(const simulation::Bone& bone) {
  ball_count = bone.balls.size();
  point_count = bone.points.size();

  std::vector<vec4> ball_data;
  ball_data.reserve(ball_count);
  for (const simulation::Ball& ball : bone.balls)
    ball_data.push_back(ToMillimetres(ball.center_m, ball.radius_m * kMillimetres));

  // whole units of volume, so that the sum of all points still fits 32 bits
  double total_mm3 = 0.0;
  for (const simulation::MassPoint& point : bone.points) total_mm3 += point.volume_m3 * 1e9;
  unit_mm3 = std::max(total_mm3, 1.0) / 4.0e9;
  std::vector<Point> point_data;
  point_data.reserve(point_count);
  for (const simulation::MassPoint& point : bone.points) {
    const vec4 p = ToMillimetres(point.p_m, 0.0);
    const double volume_mm3 = point.volume_m3 * 1e9;
    point_data.push_back({.x = p.x,
                          .y = p.y,
                          .z = p.z,
                          .volume_mm3 = static_cast<float>(volume_mm3),
                          .units = static_cast<uint>(std::llround(volume_mm3 / unit_mm3)),
                          .material = point.material,
                          .cleared = 0});
  }
  const std::vector<Cluster> ball_boxes = Boxes(ball_data, [](const vec4& ball) { return ball; });
  const std::vector<Cluster> point_boxes = Boxes(point_data, [](const Point& point) {
    return vec4{point.x, point.y, point.z, 0.0f};
  });

  const auto make = [&](std::size_t bytes) { return MakeBuffer(*context, bytes, Placement::kDevice); };
  balls = make(ball_data.size() * sizeof(vec4));
  points = make(point_data.size() * sizeof(Point));
  ball_clusters = make(ball_boxes.size() * sizeof(Cluster));
  point_clusters = make(point_boxes.size() * sizeof(Cluster));
  path_list = make(ball_boxes.size() * sizeof(Active));
  near_list = make(ball_boxes.size() * sizeof(Active));
  near_point_list = make(point_boxes.size() * sizeof(Active));
  live_list = make(ball_count * sizeof(Active));
  live_point_list = make(point_count * sizeof(Active));
  frame = make(sizeof(Frame));
  frame_in = MakeBuffer(*context, sizeof(Frame), Placement::kUpload);
  frame_out = MakeBuffer(*context, sizeof(Frame), Placement::kReadBack);
  Write(balls, ball_data.data(), ball_data.size() * sizeof(vec4));
  Write(points, point_data.data(), point_data.size() * sizeof(Point));
  Write(ball_clusters, ball_boxes.data(), ball_boxes.size() * sizeof(Cluster));
  Write(point_clusters, point_boxes.data(), point_boxes.size() * sizeof(Cluster));

  for (std::size_t i = 0; i < materials.size(); ++i)
    still.material[i] = {
        .x = static_cast<float>(materials[i].specific_cutting_energy_J_per_m3 * 1e-6),  // N/mm^2
        .y = static_cast<float>(materials[i].cutting_force_ratio),
        .z = 0.0f,
        .w = 0.0f};
  still.stiffness_N_per_mm = static_cast<float>(params.stiffness_N_per_m / kMillimetres);
  still.max_force_N = static_cast<float>(params.max_force_N);
  still.enlargement_mm = static_cast<float>(params.normal_enlargement_m * kMillimetres);
  still.tolerance_mm = static_cast<float>(params.contact_tolerance_m * kMillimetres);
  still.layer_mm = static_cast<float>(params.engaged_layer_m * kMillimetres);
  for (std::size_t t = 0; t <= tool.balls.size(); ++t) {
    const bool cuts = t < tool.balls.size() && tool.balls[t].cutting;
    lists.built[t].w = static_cast<float>(kMillimetres * (cuts ? kCuttingMargin_m : kShaftMargin_m));
  }
  // the largest summands: a touching point as far out as the tool reaches, a whole mass point in the engaged
  // layer
  double reach_mm = 1.0, largest_mm3 = 1e-3;
  for (const simulation::ToolBall& ball : tool.balls)
    reach_mm = std::max(reach_mm, kMillimetres * (Vector3(ball.center_m).norm() + ball.radius_m));
  for (const Point& point : point_data)
    largest_mm3 = std::max(largest_mm3, static_cast<double>(point.volume_mm3));
  const double largest_mm2 = largest_mm3 / (params.engaged_layer_m * kMillimetres);
  still.point_scale = static_cast<float>(kLargestSummand / (kLargestLens_mm3 * reach_mm));
  still.area_scale = static_cast<float>(kLargestSummand / largest_mm2);
  still.moment_scale = static_cast<float>(kLargestSummand / (largest_mm2 * reach_mm));
  still.max_slide_mm = static_cast<float>(params.max_slide_m * kMillimetres);
  still.tool_count = static_cast<uint>(tool.balls.size());
  still.ball_count = static_cast<uint>(ball_count);
  still.point_count = static_cast<uint>(point_count);
  for (std::size_t t = 0; t < tool.balls.size(); ++t)
    if (tool.balls[t].cutting) (t < 32 ? still.cutting_low : still.cutting_high) |= 1u << (t % 32);
  still.material_count = static_cast<uint>(materials.size());
  still.immediate = params.law == simulation::RemovalLaw::kImmediate ? 1 : 0;
}

// Runs every pass once, with a still spindle at the first ball: nothing changes, and no later frame waits for
// a compiler.
bool VulkanEngine::Impl::WarmUp(const simulation::Bone& bone) {
  if (bone.balls.empty()) return true;
  simulation::FrameInput input;
  Pose X_GT = Pose::Identity();
  X_GT.translation() = Vector3(bone.balls.front().center_m);
  input.X_WT = X_WG * X_GT;
  input.dt_s = 0.0;
  memory.X_GP = X_GT;
  Frame f = Prepare(input);
  f.ball_reach_mm = f.point_reach_mm = 1e6f;  // every cluster is near
  std::memcpy(frame_in.mapped, &f, sizeof(Frame));
  memory = {};
  return Run(kWarmUpTimeout_ns);
}

Frame VulkanEngine::Impl::Prepare(const simulation::FrameInput& input) const {
  const Pose X_GT = X_WG.inverse() * Pose(input.X_WT);
  Frame f = still;
  const simulation::ToolPoints start = PlaceTool(tool, memory.X_GP), goal = PlaceTool(tool, X_GT);
  for (std::size_t t = 0; t <= tool.balls.size(); ++t) {
    const bool is_ball = t < tool.balls.size();
    f.start[t] = ToMillimetres(start[t], is_ball ? tool.balls[t].radius_m * kMillimetres : 0.0);
    f.goal[t] = ToMillimetres(goal[t], is_ball && tool.balls[t].cutting ? 1.0 : 0.0);
  }
  f.axis_x = Unscaled(X_GT.linear().col(0));
  f.axis_y = Unscaled(X_GT.linear().col(1));
  f.axis_z = Unscaled(X_GT.linear().col(2));
  f.turn = Unscaled(LogRotation(X_GT.linear() * memory.X_GP.linear().transpose()));
  f.spindle_rad_per_s = static_cast<float>(input.spindle_rad_per_s);
  f.dt_s = static_cast<float>(input.dt_s);
  f.work_held_back_Nmm =
      static_cast<float>(memory.debt_J * std::min(1.0, input.dt_s / simulation::kDebtSeconds) * kMillimetres);
  f.path_balls = f.near_balls = f.near_points = f.reach_groups = f.place_groups =
      f.near_groups = {.x = 0, .y = 1, .z = 1};
  for (uint& bits : f.plane_gap_bits) bits = std::numeric_limits<uint>::max();
  double way_m = 0.0;
  for (std::size_t t = 0; t < start.size(); ++t) way_m = std::max(way_m, (goal[t] - start[t]).norm());
  // slide and advance together: at most max_slide, but for the immediate law, which goes all the way
  const double step_m = params.max_slide_m + (params.law == simulation::RemovalLaw::kImmediate ? way_m : 0.0);
  f.ball_reach_mm = static_cast<float>(kMillimetres * std::max(params.normal_enlargement_m, step_m));
  f.point_reach_mm = static_cast<float>(kMillimetres * std::max(params.engaged_layer_m, step_m));
  // the lists of the frames before
  f.live_balls = lists.live_balls;
  f.live_points = lists.live_points;
  f.shaft_balls = lists.shaft_balls;
  f.live_ball_count = lists.ball_count;
  f.live_point_count = lists.point_count;
  f.built = lists.built;
  f.lists_serve =
      lists.made && f.ball_reach_mm <= lists.ball_reach_mm && f.point_reach_mm <= lists.point_reach_mm ? 1
                                                                                                       : 0;
  if (f.lists_serve == 0) f.live_balls.x = 0;
  f.contact_bits = f.slide_bits = std::bit_cast<uint>(static_cast<float>(simulation::kNoContact));
  return f;
}

void VulkanEngine::Impl::KeepLists(const Frame& done) {
  if (done.rebuilt == 0) return;
  lists.made = true;
  lists.ball_reach_mm = done.ball_reach_mm;
  lists.point_reach_mm = done.point_reach_mm;
  lists.live_balls = done.live_balls;
  lists.live_points = done.live_points;
  lists.shaft_balls = done.shaft_balls;
  lists.ball_count = done.live_ball_count;
  lists.point_count = done.live_point_count;
  for (std::size_t t = 0; t <= tool.balls.size(); ++t) {
    const float margin = lists.built[t].w;
    lists.built[t] = done.contact[t];
    lists.built[t].w = margin;
  }
}

simulation::FrameSolution VulkanEngine::Impl::Solution(const Frame& done) const {
  simulation::FrameSolution s;
  s.contact_fraction = std::min(1.0f, std::bit_cast<float>(done.contact_bits));
  s.slide_fraction = std::min(done.slide_limit, std::bit_cast<float>(done.slide_bits));
  for (std::size_t g = 0; g < kPlanes; ++g) {
    simulation::SolutionPlane& plane = s.planes[g];
    plane.present = (done.planes_present >> g & 1u) != 0;
    if (!plane.present) continue;
    plane.n = Direction(done.plane_n[g]).normalized();
    plane.gap_m = done.plane_n[g].w / kMillimetres;
    plane.point_m = ToMetres(done.plane_point[g]);
    plane.weight = done.plane_point[g].w * 1e-9;
    plane.multiplier_m = done.multiplier[g] / kMillimetres;
  }
  s.turn_fraction = s.slide_fraction;
  s.delta = ToMetres(done.delta);
  s.cutting_m = done.delta.w / kMillimetres;
  s.n = s.cutting_m > 0.0 ? Vector3(Direction(done.n).normalized()) : Vector3::Zero();
  s.advance_m = done.advance_mm / kMillimetres;
  s.edge_work_J = done.edge_work_Nmm / kMillimetres;
  s.origin_contact = ToMetres(done.contact[tool.balls.size()]);
  s.origin_slid = ToMetres(done.slid[tool.balls.size()]);
  s.origin_end = ToMetres(done.end[tool.balls.size()]);
  for (std::size_t m = 0; m < materials.size(); ++m) {
    s.engaged_area_m2[m] = done.engaged[2 * m] * 1e-6;
    s.engaged_moment_m3[m] = done.engaged[2 * m + 1] * 1e-9;
    s.removed_m3[m] = done.removed[m] * unit_mm3 * 1e-9;
  }
  return s;
}

tl::expected<std::unique_ptr<VulkanEngine>, std::string> VulkanEngine::Create(
    const simulation::Bone& bone, const simulation::Tool& tool, const Pose& X_WG,
    const simulation::CuttingParams& params, const VulkanParams& vulkan) {
  if (tool.balls.empty() || tool.balls.size() > kMaxToolBalls)
    return tl::make_unexpected("tool: " + std::to_string(tool.balls.size()) + " balls, accepted 1 … " +
                               std::to_string(kMaxToolBalls));
  if (bone.materials.size() > kMaxMaterials)
    return tl::make_unexpected("bone: " + std::to_string(bone.materials.size()) +
                               " materials, accepted 1 … " + std::to_string(kMaxMaterials));
  auto context = OpenContext(vulkan.device, vulkan.validation);
  if (!context) return tl::make_unexpected(context.error());
  try {
    auto impl = std::make_unique<Impl>();
    impl->tool = tool;
    impl->materials = bone.materials;
    impl->X_WG = X_WG;
    impl->params = params;
    impl->Open(std::move(*context), vulkan.time_passes);
    impl->Upload(bone);
    impl->Build(tool);
    if (!impl->WarmUp(bone))
      return tl::make_unexpected(std::string("the Vulkan device did not finish a frame"));
    return std::unique_ptr<VulkanEngine>(new VulkanEngine(std::move(impl)));
  } catch (const vk::OutOfDeviceMemoryError&) {
    return tl::make_unexpected("not enough memory on the Vulkan device for " +
                               std::to_string(bone.balls.size()) + " balls and " +
                               std::to_string(bone.points.size()) + " mass points");
  } catch (const std::exception& error) {
    return tl::make_unexpected(std::string("Vulkan: ") + error.what());
  }
}

VulkanEngine::VulkanEngine(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VulkanEngine::~VulkanEngine() = default;

simulation::ContactModel VulkanEngine::Step(const simulation::FrameInput& input) {
  simulation::ContactModel refused;
  if (impl_->lost || !IsUsable(input)) {
    refused.status =
        impl_->lost ? simulation::EngineStatus::kDeviceLost : simulation::EngineStatus::kBadInput;
    return refused;
  }
  if (!impl_->memory.has_proxy) impl_->memory.X_GP = impl_->X_WG.inverse() * Pose(input.X_WT);
  const Frame in = impl_->Prepare(input);
  std::memcpy(impl_->frame_in.mapped, &in, sizeof(Frame));
  if (!impl_->Run(kFrameTimeout_ns)) {
    impl_->lost = true;
    refused.status = simulation::EngineStatus::kDeviceLost;
    return refused;
  }
  Frame done;
  std::memcpy(&done, impl_->frame_out.mapped, sizeof(Frame));
  impl_->KeepLists(done);
  return FinishFrame(impl_->params, impl_->materials, impl_->X_WG, input, impl_->Solution(done),
                     impl_->memory);
}

simulation::CarvedState VulkanEngine::Snapshot() const {
  simulation::CarvedState state;
  ToState(impl_->memory, state);
  if (impl_->lost) return state;  // the books alone: what lay on the device is gone
  state.balls.resize(impl_->ball_count * 4);
  impl_->Read(impl_->balls, state.balls.data(), state.balls.size() * sizeof(float));
  std::vector<Point> points(impl_->point_count);
  impl_->Read(impl_->points, points.data(), points.size() * sizeof(Point));
  state.cleared.reserve(points.size());
  for (const Point& point : points) state.cleared.push_back(static_cast<std::uint8_t>(point.cleared));
  return state;
}

void VulkanEngine::Restore(const simulation::CarvedState& state) {
  if (state.balls.size() != impl_->ball_count * 4 || state.cleared.size() != impl_->point_count)
    throw std::invalid_argument("carved state: not of this bone");
  impl_->Write(impl_->balls, state.balls.data(), state.balls.size() * sizeof(float));
  std::vector<Point> points(impl_->point_count);
  impl_->Read(impl_->points, points.data(), points.size() * sizeof(Point));
  for (std::size_t i = 0; i < points.size(); ++i) points[i].cleared = state.cleared[i];
  impl_->Write(impl_->points, points.data(), points.size() * sizeof(Point));
  impl_->Recount(impl_->ball_clusters, impl_->ball_count,
                 [&](std::size_t i) { return state.balls[4 * i + 3] > 0.0f; });
  impl_->Recount(impl_->point_clusters, impl_->point_count,
                 [&](std::size_t i) { return state.cleared[i] == 0; });
  impl_->memory = simulation::ToMemory(state);
  impl_->lists.made = false;
}

std::string VulkanEngine::device() const { return impl_->context->info.name; }

std::vector<PassTime> VulkanEngine::LastPassTimes() const {
  return impl_->memory.frame == 0 ? std::vector<PassTime>{} : impl_->PassTimes();
}

int VulkanEngine::validation_messages() const {
  return impl_->context->validation ? impl_->context->validation->messages.load() : 0;
}

}  // namespace osteon::gpu
