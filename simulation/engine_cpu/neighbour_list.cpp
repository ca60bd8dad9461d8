#include "simulation/engine_cpu/neighbour_list.h"

#include <algorithm>
#include <array>
#include <bit>

#include "simulation/bone/material.h"

namespace osteon::simulation::cpu {
namespace {

// Number of blocks of points that are written at set-up, so that their memory pages exist before the first
// frame.
constexpr std::size_t kTouchedBlocks = 1u << 13;
// Number of split balls for which memory is reserved at set-up.
constexpr std::size_t kReservedSplits = 65'536;

}  // namespace

NeighbourList::NeighbourList(const ListSources& sources, std::size_t max_rows)
    : from_(sources),
      built_at_(sources.tool.count()),
      place_of_point_(sources.bone.point_count(), 0),
      new_tools_(sources.tool.count()),
      new_bounds_(sources.tool.count()) {
  const BoneStore& bone = from_.bone;
  std::size_t max_blocks = bone.first_child_block();
  if (from_.split != nullptr) {
    max_blocks += from_.split->params().pool_blocks * from_.split->stride();
    children_.reserve(std::min(from_.split->params().pool_blocks, kReservedSplits));
    split_since_.reserve(std::min(from_.split->params().pool_blocks, kReservedSplits));
  }
  ball_rows_ = PairRowList(max_blocks, std::min(max_rows, max_blocks * from_.tool.count()));
  point_lists_.resize(bone.material_count());
  for (std::size_t m = 0; m < point_lists_.size(); ++m) {
    const std::size_t blocks = bone.MaxPointBlocks(m);
    point_lists_[m].blocks = AlignedArray<PointBlock>(blocks, kTouchedBlocks);
    point_lists_[m].rows = PairRowList(blocks, std::min(max_rows, blocks * from_.tool.cutting_count()));
  }
  from_.search.Reserve(balls_), from_.search.Reserve(points_);
  cleared_since_.reserve(bone.point_count());
}

RowMaker NeighbourList::MakerOf(const ListReach& reach) const {
  return {.tool = from_.tool.view(),
          .at = built_at_.places(),
          .cutting_reach_mm = reach.cutting_mm,
          .shaft_reach_mm = reach.shaft_mm,
          .out_tool = nullptr,
          .out_bound = nullptr};
}

void NeighbourList::Begin(const ToolPlacement& at, const ListReach& reach, const ListReach& point_reach) {
  is_begun_ = true, is_made_ = overflowed_ = false;
  reach_ = reach, point_reach_ = point_reach;
  built_at_.CopyFrom(at);
  children_.clear(), split_since_.clear(), cleared_since_.clear();
  next_child_ = listed_points_ = 0;
  ball_rows_.Clear();
  for (PointList& list : point_lists_) {
    list.block_count = 0;
    list.rows.Clear();
  }
  const bool fits =
      from_.search.Find(from_.kernels, from_.bone.ball_tree, built_at_, reach_, false, balls_) &&
      from_.search.Find(from_.kernels, from_.bone.point_tree, built_at_, point_reach_, true, points_);
  overflowed_ = !fits;
  if (from_.split == nullptr) return;
  // children lie inside their parent, so they are near the tool if the parent's cluster is
  for (std::size_t i = 0; i < balls_.cluster.size(); ++i)
    from_.split->EachIn(balls_.cluster[i], [&](std::uint32_t number) {
      children_.emplace_back(number, static_cast<std::uint32_t>(i));
    });
  std::sort(children_.begin(), children_.end());
}

bool NeighbourList::all_visited() const {
  return balls_.left() == 0 && points_.left() == 0 && next_child_ == children_.size();
}

void NeighbourList::Continue(std::size_t ball_clusters, std::size_t point_clusters) {
  for (; ball_clusters > 0 && balls_.left() > 0 && !overflowed_; --ball_clusters) ListBallCluster();
  // list children only after all parents, because their blocks have higher indices
  for (; ball_clusters > 0 && balls_.left() == 0 && next_child_ < children_.size() && !overflowed_;
       --ball_clusters)
    ListChild();
  for (; point_clusters > 0 && points_.left() > 0 && !overflowed_; --point_clusters) ListPointCluster();
}

void NeighbourList::ListBlocks(std::uint32_t first_block, std::uint32_t end_block,
                               std::span<const std::uint16_t> tools, bool& any) {
  RowMaker maker = MakerOf(reach_);
  for (std::uint32_t b = first_block; b < end_block; ++b) {
    if (!ball_rows_.HasRoom(tools.size())) {
      overflowed_ = true;
      return;
    }
    maker.out_tool = ball_rows_.free_tools(), maker.out_bound = ball_rows_.free_bounds();
    const std::size_t rows =
        from_.kernels.ball_rows(maker, from_.bone.blocks()[b], tools.data(), tools.size());
    if (rows > 0) ball_rows_.Add(b, rows);
    any = any || rows > 0;
  }
}

void NeighbourList::ListBallCluster() {
  const std::uint32_t cluster = balls_.cluster[balls_.next];
  const auto tools =
      from_.search.ToolsNear(from_.kernels, from_.bone.ball_tree, balls_, balls_.next, MakerOf(reach_));
  bool any = false;
  ListBlocks(8 * cluster, 8 * cluster + 8, tools, any);
  ++balls_.next;
  const bool has_children = from_.split != nullptr && from_.split->HasAnyIn(cluster);
  if (!any && !overflowed_ && !has_children && !from_.bone.AnyLeft(8 * cluster, 8 * cluster + 8))
    from_.bone.ball_tree.Drop(cluster);
}

void NeighbourList::ListChild() {
  const auto [number, place] = children_[next_child_++];
  const auto tools =
      from_.search.ToolsNear(from_.kernels, from_.bone.ball_tree, balls_, place, MakerOf(reach_));
  const std::uint32_t first = from_.split->FirstBlock(number);
  bool any = false;
  ListBlocks(first, first + from_.split->stride(), tools, any);
}

void NeighbourList::AddChildren(std::uint32_t number) {
  const std::uint32_t cluster = from_.split->ParentCluster(number);
  const auto at = std::lower_bound(balls_.cluster.begin(), balls_.cluster.end(), cluster);
  if (at == balls_.cluster.end() || *at != cluster) return;  // the cluster is out of reach
  RowMaker maker = MakerOf(reach_);
  const auto tools = from_.search.ToolsNear(from_.kernels, from_.bone.ball_tree, balls_,
                                            static_cast<std::size_t>(at - balls_.cluster.begin()), maker);
  maker.out_tool = new_tools_.data(), maker.out_bound = new_bounds_.data();
  const std::uint32_t first = from_.split->FirstBlock(number);
  for (std::uint32_t b = first; b < first + from_.split->stride(); ++b) {
    const std::size_t rows =
        from_.kernels.ball_rows(maker, from_.bone.blocks()[b], tools.data(), tools.size());
    if (!ball_rows_.Replace(b, new_tools_.data(), new_bounds_.data(), rows)) overflowed_ = true;
  }
}

void NeighbourList::ListPointCluster() {
  BoneStore& bone = from_.bone;
  const std::uint32_t cluster = points_.cluster[points_.next];
  if (bone.PointsLeft(cluster) == 0) {
    bone.point_tree.Drop(cluster);
    ++points_.next;
    return;
  }
  const RowMaker maker = MakerOf(point_reach_);
  const auto tools = from_.search.ToolsNear(from_.kernels, bone.point_tree, points_, points_.next, maker);
  ++points_.next;
  const std::uint32_t first = BoxTree::kCluster * cluster;
  const auto last =
      static_cast<std::uint32_t>(std::min<std::size_t>(bone.point_count(), first + BoxTree::kCluster));
  std::array<std::uint32_t, kMaxMaterials> lanes{};  // lanes in use in each material's open block
  for (std::uint32_t i = first; i < last; i += 8) {
    unsigned bits = from_.kernels.points_near(maker, bone.point_mm(0) + i, bone.point_mm(1) + i,
                                              bone.point_mm(2) + i, tools.data(), tools.size());
    if (last - i < 8) bits &= (1u << (last - i)) - 1u;
    for (; bits != 0; bits &= bits - 1) {
      const std::uint32_t point = i + static_cast<std::uint32_t>(std::countr_zero(bits));
      if (!bone.is_cleared(point)) AddPoint(point, tools, lanes[bone.material(point)]);
    }
  }
  for (std::size_t m = 0; m < point_lists_.size(); ++m) ClosePointBlock(point_lists_[m], tools, lanes[m]);
}

void NeighbourList::AddPoint(std::uint32_t point, std::span<const std::uint16_t> tools,
                             std::uint32_t& lanes) {
  const BoneStore& bone = from_.bone;
  PointList& list = point_lists_[bone.material(point)];
  PointBlock& block = list.blocks[list.block_count];
  block.x[lanes] = bone.point_mm(0)[point], block.y[lanes] = bone.point_mm(1)[point];
  block.z[lanes] = bone.point_mm(2)[point];
  block.index[lanes] = point;
  block.area_m2[lanes] = bone.layer_area_m2(point);
  place_of_point_[point] = static_cast<std::uint32_t>(8 * list.block_count + lanes);
  ++listed_points_;
  if (++lanes == 8) ClosePointBlock(list, tools, lanes);
}

void NeighbourList::ClosePointBlock(PointList& list, std::span<const std::uint16_t> tools,
                                    std::uint32_t& lanes) {
  if (lanes == 0) return;
  PointBlock& block = list.blocks[list.block_count];
  for (; lanes < 8; ++lanes) {
    block.x[lanes] = block.y[lanes] = block.z[lanes] = kFarAway_mm;
    block.index[lanes] = 0, block.area_m2[lanes] = 0.0;
  }
  lanes = 0;
  if (!list.rows.HasRoom(tools.size())) {
    overflowed_ = true;
    return;
  }
  RowMaker maker = MakerOf(point_reach_);
  maker.out_tool = list.rows.free_tools(), maker.out_bound = list.rows.free_bounds();
  const std::size_t rows = from_.kernels.point_rows(maker, block, tools.data(), tools.size());
  if (rows > 0) list.rows.Add(static_cast<std::uint32_t>(list.block_count), rows);
  ++list.block_count;
}

// Applies the splits and clearings that were recorded during the build.
void NeighbourList::End() {
  for (const std::uint32_t number : split_since_) AddChildren(number);
  for (const std::uint32_t point : cleared_since_) {
    PointList& list = point_lists_[from_.bone.material(point)];
    const std::size_t block = place_of_point_[point] / 8, k = place_of_point_[point] % 8;
    if (block >= list.block_count || list.blocks[block].index[k] != point) continue;  // not listed
    PointBlock& at = list.blocks[block];
    at.x[k] = at.y[k] = at.z[k] = kFarAway_mm;
    at.area_m2[k] = 0.0;
  }
  is_made_ = true, is_begun_ = false;
}

}  // namespace osteon::simulation::cpu
