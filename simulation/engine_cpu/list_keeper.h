#pragma once

#include <algorithm>
#include <array>

#include "simulation/engine_cpu/neighbour_list.h"

namespace osteon::simulation::cpu {

/// Distance from the tool up to which a frame needs balls and mass points [mm], without skin.
struct FrameReach {
  double ball_mm{0.0}, point_mm{0.0};
};

/// Keeps a valid neighbour list ready. While the tool moves within the skin of the list in use, the next list
/// is built in slices over several frames. So a frame rarely has to build a whole list.
class ListKeeper {
 public:
  /// @param brute_force  list all pairs, and build the list anew in every frame
  ListKeeper(const ListSources& sources, std::size_t max_rows, bool brute_force, bool look_ahead);

  [[nodiscard]] double max_skin_mm() const { return 1e3 * std::max(cutting_skin_m_, shaft_skin_m_); }
  /// Whether the list holds every pair within this reach while the tool is at this placement.
  [[nodiscard]] bool Serves(const ToolPlacement& at, const FrameReach& reach) const;
  /// The same test of the placement only, for a reach that Serves or MakeAt has already accepted.
  [[nodiscard]] bool Serves(const ToolPlacement& at) const { return brute_force_ || SkinUsed(at) <= 1.0; }
  /// Builds the list at once. @returns false if there are more pairs than the list has room for
  [[nodiscard]] bool MakeAt(const ToolPlacement& at, const FrameReach& reach);
  /// Builds a slice of the next list, once half of the skin is used. Call at the end of a frame.
  void MakeAhead(const ToolPlacement& at, const FrameReach& reach);

  /// Adds a displacement of the tool: the largest one of any of its balls.
  void AddDisplacement(double mm) { displacement_mm_ += mm; }
  /// Displacement since the list was built: the sum by which a gap can have closed at most.
  [[nodiscard]] float displacement_mm() const {
    return static_cast<float>(displacement_mm_ - displacement_at_[serving_]);
  }
  [[nodiscard]] PairRows ball_rows() { return list().ball_rows().rows(); }
  [[nodiscard]] std::vector<PointList>& point_lists() { return list().point_lists(); }

  /// These functions report to the lists a point that was cleared, and a ball whose children were made.
  void NoteCleared(std::uint32_t point);
  void AddChildren(std::uint32_t number);
  /// Discards all lists. Call it when the bone's state was replaced.
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
  std::size_t serving_{0};  // index of the list in use
  double displacement_mm_{0.0};
  double used_before_{0.0}, used_per_frame_{0.0};  // fraction of the skin used: in total; per frame
  std::size_t slices_{1};
  bool made_in_frame_{false};
};

}  // namespace osteon::simulation::cpu
