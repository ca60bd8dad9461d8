#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "simulation/surface/field_distance.h"

namespace osteon::session {

/// The largest difference of two bones, and its place.
struct LargestDifference {
  double depth_mm{0.0};  ///< positive: the second recording's bone is cut deeper
  surface::Vec3 p_mm{};  ///< the place, in the bone's frame G
};

/// Exchanges the carved bones of two recordings that are shown side by side (sides 0 and 1), so that each
/// side can show a map of the difference.
///
///     side 0 carves ──Tell──▶ newest bone of each ──Take──▶ side 1 colours its surface, and the reverse
///
/// Any thread. Nothing is copied while the map is off.
class BoneDifference {
 public:
  /// While the map is on, a vertex's material index is kZero plus the difference in steps. The largest
  /// distance that the fields know, 3 voxels, is kZero - 1 steps.
  static constexpr int kZero = 64;
  [[nodiscard]] static float StepFor(float voxel_mm) {
    return surface::kBandVoxels * voxel_mm / static_cast<float>(kZero - 1);
  }

  /// Switches the map on or off.
  void Show(bool on) { on_.store(on); }
  [[nodiscard]] bool on() const { return on_.load(); }

  /// The changes of one side's bone, for the other side.
  struct News {
    surface::CarvedSnapshot bone;
    std::vector<surface::BrickIndex> changed{};  ///< bricks of that side's grid, since the last Take
    bool all{false};                             ///< every brick may have changed
  };
  /// Stores a side's newest bone for the other side.
  /// @param side  0 or 1: the side that has this bone  @param changed  bricks whose surface has changed;
  /// ignored if `all`
  void Tell(std::size_t side, surface::CarvedSnapshot bone, std::span<const surface::BrickIndex> changed,
            bool all);
  /// Returns the changes of the other side's bone since the last call. @param side  0 or 1: the side that
  /// asks
  [[nodiscard]] News Take(std::size_t side);
  /// Stores the largest difference that a side has found.
  void TellLargest(std::size_t side, LargestDifference largest);

  /// Makes {"type": "bone_difference", "on", "range_mm": end of the colour scale, "largest_mm": signed,
  /// positive where the second is deeper, "at_mm": [x, y, z] in G, "limit_mm": larger differences are not
  /// distinguished}.
  [[nodiscard]] std::string Json() const;

 private:
  std::atomic<bool> on_{false};
  mutable std::mutex mutex_;  // guards the following members
  std::array<News, 2> told_;  // told_[side]: changes of that side's bone, for the other side
  std::array<LargestDifference, 2> largest_;
};

/// One side's map: colours its chunks by the distance to the other side's bone. Call it from one thread only.
class DifferenceMap {
 public:
  /// @param shared  must outlive this object  @param side  0 or 1
  DifferenceMap(BoneDifference& shared, std::size_t side) : shared_(shared), side_(side) {}

  /// Follows BoneDifference::Show. @returns whether the map was switched on or off since the last call; every
  /// brick then has to be sent again.
  [[nodiscard]] bool Switched();
  [[nodiscard]] bool on() const { return on_; }

  /// Forgets what was shown. Call it after the side's bone has jumped to another time.
  void Restart();
  /// Tells the other side which bricks have changed on this side, and asks which have changed on the other
  /// one.
  /// @param dirty  bricks of `field` that have changed
  /// @returns the bricks to extract: the dirty ones, and those whose colour may have changed
  [[nodiscard]] std::vector<surface::BrickIndex> Update(
      const surface::CarvedField& field, const std::shared_ptr<const surface::SolidField>& solid,
      std::span<const surface::BrickIndex> dirty);
  /// If the map is on, replaces the materials of a chunk by steps of difference (BoneDifference::kZero).
  void Colour(const surface::CarvedField& field, surface::SurfaceChunk& chunk);
  /// Stores the largest difference of all chunks that were coloured in the shared BoneDifference.
  void TellLargest();

 private:
  // Adds to `bricks` the shown bricks whose colour may change because the other side's bone has changed.
  void AddNear(const surface::CarvedField& field, const BoneDifference::News& news,
               std::set<surface::BrickIndex>& bricks) const;

  BoneDifference& shared_;
  const std::size_t side_;
  bool on_{false};
  bool restarted_{true};           // the other side must be told that every brick may have changed
  surface::CarvedSnapshot other_;  // the other side's newest bone
  // bricks that have a surface, with their largest difference
  std::map<surface::BrickIndex, LargestDifference> shown_;
};

}  // namespace osteon::session
