#include "simulation/engine_cpu/list_keeper.h"

#include <algorithm>

#include "simulation/engine_cpu/rounding.h"

namespace osteon::simulation::cpu {
namespace {

constexpr double kEverything_mm = 1e9;  // a reach that excludes nothing
constexpr std::size_t kMaxSlices = 32;  // largest number of frames over which a list is built
// A list is rebuilt at the latest when the tool's displacement since it was built reaches this multiple of
// the widest skin. The displacement adds up while a tool moves to and fro within the skin, and a larger sum
// is less precise as a float.
constexpr double kMaxDisplacement = 8.0;

// Returns the skin of the cutting balls [m]. If there is only one cutting ball, the skin is wider, a tenth of
// the ball's radius: this costs almost no time, because far blocks are skipped by their bounds. Shaft balls
// have a wider skin still, because they move farther when the tool turns and are mostly far from bone.
double CuttingSkin(const ToolBalls& tool) {
  if (tool.cutting_count() != 1) return 0.25e-3;
  return std::clamp(0.1e-3 * tool.max_radius_mm(), 0.2e-3, 1.0e-3);
}

}  // namespace

ListKeeper::ListKeeper(const ListSources& sources, std::size_t max_rows, bool brute_force, bool look_ahead)
    : sources_(sources),
      brute_force_(brute_force),
      look_ahead_(look_ahead && !brute_force),
      cutting_skin_m_(CuttingSkin(sources.tool)),
      shaft_skin_m_(std::max(0.8e-3, 2.0 * cutting_skin_m_)),
      lists_{NeighbourList(sources_, max_rows), NeighbourList(sources_, max_rows)} {}

// Returns the fraction of the skin that is used up with the tool at this placement. Above 1, the list may
// miss pairs.
double ListKeeper::SkinUsed(const ToolPlacement& at) const {
  const Places &was = list().built_at().places(), &is = at.places();
  const auto used = [&](const ToolBalls::Range& range, double skin_m) {
    return sources_.kernels.farthest(was, is, range.first, range.end) / skin_m;
  };
  return std::max({used(sources_.tool.cutting(), cutting_skin_m_), used(sources_.tool.shaft(), shaft_skin_m_),
                   displacement_mm() / (kMaxDisplacement * max_skin_mm())});
}

bool ListKeeper::Serves(const ToolPlacement& at, const FrameReach& reach) const {
  if (brute_force_ || !list().is_made() || list().overflowed()) return false;
  const FrameReach& has = reach_[serving_];
  return reach.ball_mm <= has.ball_mm && reach.point_mm <= has.point_mm && Serves(at);
}

// Begins to build one of the two lists at this placement, for this reach plus the skin.
void ListKeeper::Begin(std::size_t which, const ToolPlacement& at, const FrameReach& reach) {
  reach_[which] = reach;
  displacement_at_[which] = displacement_mm_;
  const auto with_skin = [&](double mm) {
    if (brute_force_) mm = kEverything_mm;
    return ListReach{.cutting_mm = static_cast<float>(mm + 1e3 * cutting_skin_m_) + kListSlack_mm,
                     .shaft_mm = static_cast<float>(mm + 1e3 * shaft_skin_m_) + kListSlack_mm};
  };
  lists_[which].Begin(at, with_skin(reach.ball_mm), with_skin(reach.point_mm));
}

bool ListKeeper::MakeAt(const ToolPlacement& at, const FrameReach& reach) {
  made_in_frame_ = true;
  next().Discard();
  Begin(serving_, at, reach);
  list().Continue(list().ball_clusters(), list().point_clusters());
  list().End();
  used_before_ = 0.0;
  if (!list().overflowed()) return true;
  list().Discard();
  return false;
}

void ListKeeper::MakeAhead(const ToolPlacement& at, const FrameReach& reach) {
  if (!look_ahead_) return;
  const double used = SkinUsed(at);
  // running mean over about five frames of the skin used per frame
  used_per_frame_ += 0.2 * (std::max(0.0, used - used_before_) - used_per_frame_);
  used_before_ = used;
  // begin the next list when half of the skin is used; afterwards build one slice in each frame
  if (!next().is_begun()) {
    if (used < 0.5) return;
    Begin(1 - serving_, at, reach);
    // the next list should be complete when three quarters of the remaining skin are used
    const double frames = used_per_frame_ > 0.0 ? 0.75 * (1.0 - used) / used_per_frame_ : kMaxSlices;
    slices_ = static_cast<std::size_t>(std::clamp<double>(frames, 1.0, kMaxSlices));
    return;
  }
  next().Continue(next().ball_clusters() / slices_ + 1, next().point_clusters() / slices_ + 1);
  if (next().overflowed()) return next().Discard();
  if (!next().all_visited()) return;
  next().End();
  if (next().overflowed()) return next().Discard();
  used_before_ = 0.0;
  serving_ = 1 - serving_;
  next().Discard();
}

void ListKeeper::NoteCleared(std::uint32_t point) {
  if (next().is_begun()) next().NoteCleared(point);
}

void ListKeeper::AddChildren(std::uint32_t number) {
  list().AddChildren(number);
  if (next().is_begun()) next().NoteSplit(number);
}

void ListKeeper::Discard() {
  for (NeighbourList& l : lists_) l.Discard();
  used_before_ = 0.0;
}

}  // namespace osteon::simulation::cpu
