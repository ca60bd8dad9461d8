#include "session/view/bone_difference.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "report/ticks.h"

namespace osteon::session {
namespace {

using surface::BrickIndex;
using surface::BrickLayout;
using surface::CarvedField;
using surface::Vec3;

// Smallest range of the colour scale, because smaller differences are errors of the distance fields.
constexpr double kMinRange_mm = 0.05;
constexpr std::size_t kMaxChanged = 1 << 16;  // if more bricks have changed, all count as changed

bool IsLarger(const LargestDifference& a, const LargestDifference& b) {
  return std::abs(a.depth_mm) > std::abs(b.depth_mm);
}

// Calls visit(brick) for each brick of a grid that touches a box.
template <class Visit>
void EachBrickIn(const BrickLayout& layout, Vec3 min_mm, Vec3 max_mm, const Visit& visit) {
  const float edge_mm = layout.voxel_mm * surface::kBrickEdge;
  // index of the brick at a coordinate; -1 or `count` outside the grid
  const auto brick = [&](float p, float origin, int count) {
    return static_cast<int>(std::clamp(std::floor((p - origin) / edge_mm), -1.0F, static_cast<float>(count)));
  };
  const Vec3 origin_mm = layout.origin_mm;
  const auto [nx, ny, nz] = layout.bricks;
  for (int z = std::max(0, brick(min_mm.z, origin_mm.z, nz));
       z <= std::min(nz - 1, brick(max_mm.z, origin_mm.z, nz)); ++z)
    for (int y = std::max(0, brick(min_mm.y, origin_mm.y, ny));
         y <= std::min(ny - 1, brick(max_mm.y, origin_mm.y, ny)); ++y)
      for (int x = std::max(0, brick(min_mm.x, origin_mm.x, nx));
           x <= std::min(nx - 1, brick(max_mm.x, origin_mm.x, nx)); ++x)
        visit(layout.At(x, y, z));
}

}  // namespace

void BoneDifference::Tell(std::size_t side, surface::CarvedSnapshot bone, std::span<const BrickIndex> changed,
                          bool all) {
  const std::lock_guard lock(mutex_);
  News& told = told_[side];
  told.bone = std::move(bone);
  told.all = told.all || all || told.changed.size() + changed.size() > kMaxChanged;
  if (told.all)
    told.changed.clear();
  else
    told.changed.insert(told.changed.end(), changed.begin(), changed.end());
}

BoneDifference::News BoneDifference::Take(std::size_t side) {
  const std::lock_guard lock(mutex_);
  News& told = told_[1 - side];
  return {
      .bone = told.bone, .changed = std::exchange(told.changed, {}), .all = std::exchange(told.all, false)};
}

void BoneDifference::TellLargest(std::size_t side, LargestDifference largest) {
  const std::lock_guard lock(mutex_);
  largest_[side] = largest;
}

std::string BoneDifference::Json() const {
  const std::lock_guard lock(mutex_);
  const LargestDifference& largest = IsLarger(largest_[1], largest_[0]) ? largest_[1] : largest_[0];
  double limit_mm = 0.0;  // width of the band of known distances in the coarser field
  for (const News& told : told_)
    if (told.bone.solid)
      limit_mm =
          std::max(limit_mm, static_cast<double>(surface::kBandVoxels * told.bone.solid->layout().voxel_mm));
  const auto rounded = [](double mm) { return std::round(1e3 * mm) / 1e3; };
  return nlohmann::json{
      {"type", "bone_difference"},
      {"on", on()},
      {"range_mm", report::NiceStep(std::max(kMinRange_mm, std::abs(largest.depth_mm)))},
      {"largest_mm", rounded(largest.depth_mm)},
      {"at_mm", {rounded(largest.p_mm.x), rounded(largest.p_mm.y), rounded(largest.p_mm.z)}},
      {"limit_mm", limit_mm}}
      .dump();
}

bool DifferenceMap::Switched() {
  if (on_ == shared_.on()) return false;
  on_ = !on_;
  Restart();
  return true;
}

void DifferenceMap::Restart() {
  shown_.clear();
  restarted_ = true;
}

// Adds the shown bricks whose distance to the other bone may have changed. These are the bricks within the
// distance field's band (kBandVoxels) around a changed brick of the other bone.
void DifferenceMap::AddNear(const CarvedField& field, const BoneDifference::News& news,
                            std::set<BrickIndex>& bricks) const {
  if (news.all) {
    for (const auto& [brick, largest] : shown_) bricks.insert(brick);
    return;
  }
  const BrickLayout& other = news.bone.solid->layout();
  const float edge = static_cast<float>(surface::kBrickEdge), band = surface::kBandVoxels;  // in voxels
  for (const BrickIndex changed : news.changed) {
    const auto [x, y, z] = other.PlaceOf(changed);
    const Vec3 low = other.Node(x * surface::kBrickEdge, y * surface::kBrickEdge, z * surface::kBrickEdge);
    const float before_mm = band * other.voxel_mm, behind_mm = (edge + band) * other.voxel_mm;
    EachBrickIn(field.layout(), low - Vec3{before_mm, before_mm, before_mm},
                low + Vec3{behind_mm, behind_mm, behind_mm}, [&](BrickIndex brick) {
                  if (shown_.contains(brick)) bricks.insert(brick);
                });
  }
}

std::vector<BrickIndex> DifferenceMap::Update(const CarvedField& field,
                                              const std::shared_ptr<const surface::SolidField>& solid,
                                              std::span<const BrickIndex> dirty) {
  if (!on_) return {dirty.begin(), dirty.end()};
  if (!dirty.empty() || restarted_)
    shared_.Tell(side_, {.solid = solid, .swept = std::make_shared<const surface::BrickField>(field.swept())},
                 dirty, std::exchange(restarted_, false));
  const BoneDifference::News news = shared_.Take(side_);
  other_ = news.bone;
  std::set<BrickIndex> bricks(dirty.begin(), dirty.end());
  if (other_.solid) AddNear(field, news, bricks);
  return {bricks.begin(), bricks.end()};
}

void DifferenceMap::Colour(const CarvedField& field, surface::SurfaceChunk& chunk) {
  if (!on_) return;
  LargestDifference largest;
  const bool known = other_.solid && !surface::SameAround(field, other_, chunk.brick);
  const float step_mm = BoneDifference::StepFor(field.layout().voxel_mm);
  for (surface::SurfaceVertex& vertex : chunk.vertices) {
    vertex.material = BoneDifference::kZero;
    if (!known) continue;
    const float distance_mm = surface::CarvedDistance(other_.solid->layout(), other_.solid->distances(),
                                                      *other_.swept, vertex.p_mm);
    // if distance_mm is positive, the vertex lies outside the other bone, so that the other bone is cut
    // deeper here
    const float depth_mm = side_ == 0 ? distance_mm : -distance_mm;
    if (const LargestDifference here{depth_mm, vertex.p_mm}; IsLarger(here, largest)) largest = here;
    const long steps = std::lround(depth_mm / step_mm);
    vertex.material =
        static_cast<std::uint8_t>(BoneDifference::kZero + std::clamp<long>(steps, 1 - BoneDifference::kZero,
                                                                           BoneDifference::kZero - 1));
  }
  if (chunk.quads.empty())
    shown_.erase(chunk.brick);
  else
    shown_[chunk.brick] = largest;
}

void DifferenceMap::TellLargest() {
  LargestDifference largest;
  for (const auto& [brick, each] : shown_)
    if (IsLarger(each, largest)) largest = each;
  shared_.TellLargest(side_, largest);
}

}  // namespace osteon::session
