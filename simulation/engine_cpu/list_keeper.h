#pragma once

#include <algorithm>
#include <array>

#include "simulation/engine_cpu/neighbour_list.h"

namespace osteon::simulation::cpu {

/// How far a frame has to see around the tool [mm], without skin: balls, and mass points.
struct FrameReach {
  double ball_mm{0.0}, point_mm{0.0};
};

/// Has a neighbour list ready at all times: one that serves, and the next one, which is made in slices while
/// the first one's skin is used up, so that hardly any frame pays for a whole list.
class ListKeeper {
 public:
  /// @param brute_force  lists of all pairs, made anew in every frame
  ListKeeper(const ListSources& sources, std::size_t max_rows, bool brute_force, bool look_ahead);

  [[nodiscard]] double max_skin_mm() const { return 1e3 * std::max(cutting_skin_m_, shaft_skin_m_); }
  /// Whether the list holds every pair that matters while the tool is there, with this reach.
  [[nodiscard]] bool Serves(const ToolPlacement& at, const FrameReach& reach) const;
  /// The same for a frame's reach that has been looked at.
  [[nodiscard]] bool Serves(const ToolPlacement& at) const { return brute_force_ || SkinUsed(at) <= 1.0; }
  /// Makes the list at once. @returns false where there are more pairs than there is room for.
  [[nodiscard]] bool MakeAt(const ToolPlacement& at, const FrameReach& reach);
  /// At the end of a frame: a slice of the next list, once half of the skin is used.
  void MakeAhead(const ToolPlacement& at, const FrameReach& reach);

  /// The tool has moved by so much, at most any of its balls.
  void AddDisplacement(double mm) { displacement_mm_ += mm; }
  /// Since the list was made: no gap has closed by more.
  [[nodiscard]] float displacement_mm() const {
    return static_cast<float>(displacement_mm_ - displacement_at_[serving_]);
  }
  [[nodiscard]] PairRows ball_rows() { return list().ball_rows().rows(); }
  [[nodiscard]] std::vector<PointList>& point_lists() { return list().point_lists(); }

  void NoteCleared(std::uint32_t point);
  void AddChildren(std::uint32_t number);
  /// The state is another one: no list serves.
  void Discard();

  [[nodiscard]] std::size_t ball_row_count() const { return list().ball_row_count(); }
  [[nodiscard]] std::size_t ball_block_count() const { return list().ball_block_count(); }
  [[nodiscard]] std::size_t listed_points() const { return list().listed_points(); }
  [[nodiscard]] bool made_in_frame() const { return made_in_frame_; }
  void BeginFrame() { made_in_frame_ = false; }

 private:
  [[nodiscard]] NeighbourList& list() { return lists_[serving_]; }
  [[nodiscard]] const NeighbourList& list() const { return lists_[serving_]; }
  [[nodiscard]] NeighbourList& next() { return lists_[1 - serving_]; }
  [[nodiscard]] double SkinUsed(const ToolPlacement& at) const;
  void Begin(std::size_t which, const ToolPlacement& at, const FrameReach& reach);

  ListSources sources_;
  bool brute_force_, look_ahead_;
  double cutting_skin_m_, shaft_skin_m_;
  std::array<NeighbourList, 2> lists_;
  std::array<FrameReach, 2> reach_{};
  std::array<double, 2> displacement_at_{};
  std::size_t serving_{0};
  double displacement_mm_{0.0};
  double used_before_{0.0}, used_per_frame_{0.0};  // of the skin
  std::size_t slices_{1};
  bool made_in_frame_{false};
};

}  // namespace osteon::simulation::cpu
