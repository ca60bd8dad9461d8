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

/// Where a difference is largest.
struct LargestDifference {
  double depth_mm{0.0};  ///< positive where the second recording's bone is cut deeper
  surface::Vec3 p_mm{};  ///< in the bone's frame G
};

/// What the two sides of a comparison know of each other's bone, for a map of the difference on both.
///
///     side 0 carves ──Tell──▶ newest bone of each ──Take──▶ side 1 colours its surface, and the reverse
///
/// Any thread. Nothing is copied while the map is off.
class BoneDifference {
 public:
  /// A vertex's material is a number of steps then, kZero for none; 3 voxels, the fields' limit, are kZero
  /// - 1.
  static constexpr int kZero = 64;
  [[nodiscard]] static float StepFor(float voxel_mm) {
    return surface::kBandVoxels * voxel_mm / static_cast<float>(kZero - 1);
  }

  void Show(bool on) { on_.store(on); }
  [[nodiscard]] bool on() const { return on_.load(); }

  /// What a side learns of the other one.
  struct News {
    surface::CarvedSnapshot bone;
    std::vector<surface::BrickIndex> changed{};  ///< of the other's grid, since the last Take
    bool all{false};                             ///< every brick may have changed
  };
  /// @param side  0 or 1: whose bone this is  @param changed  bricks whose surface has changed; ignored if
  /// `all`
  void Tell(std::size_t side, surface::CarvedSnapshot bone, std::span<const surface::BrickIndex> changed,
            bool all);
  /// @param side  0 or 1: who asks
  [[nodiscard]] News Take(std::size_t side);
  void TellLargest(std::size_t side, LargestDifference largest);

  /// {"type": "bone_difference", "on", "range_mm": of the colours, "largest_mm": signed, positive where the
  /// second is deeper, "at_mm": [x, y, z] in G, "limit_mm": larger ones are not told apart}
  [[nodiscard]] std::string Json() const;

 private:
  std::atomic<bool> on_{false};
  mutable std::mutex mutex_;  // of what follows
  std::array<News, 2> told_;  // by each side, for the other
  std::array<LargestDifference, 2> largest_;
};

/// One side's map: colours its chunks by the distance to the other side's bone. One thread.
class DifferenceMap {
 public:
  /// @param shared  outlives this  @param side  0 or 1
  DifferenceMap(BoneDifference& shared, std::size_t side) : shared_(shared), side_(side) {}

  /// Whether the map has been switched on or off since the last call; then every brick has to be sent again.
  [[nodiscard]] bool Switched();
  [[nodiscard]] bool on() const { return on_; }

  /// Forgets what was shown, since the side's bone has jumped to another time.
  void Restart();
  /// Tells the other side what has changed, and finds out what has changed there.
  /// @param dirty  bricks of `field` that have changed
  /// @returns the bricks to extract: these, and those whose colour has changed
  [[nodiscard]] std::vector<surface::BrickIndex> Update(
      const surface::CarvedField& field, const std::shared_ptr<const surface::SolidField>& solid,
      std::span<const surface::BrickIndex> dirty);
  /// Replaces the materials of a chunk by steps of difference, where the map is on.
  void Colour(const surface::CarvedField& field, surface::SurfaceChunk& chunk);
  /// Tells the largest difference of all chunks that were coloured.
  void TellLargest();

 private:
  void AddNear(const surface::CarvedField& field, const BoneDifference::News& news,
               std::set<surface::BrickIndex>& bricks) const;

  BoneDifference& shared_;
  const std::size_t side_;
  bool on_{false}, restarted_{true};
  surface::CarvedSnapshot other_;
  std::map<surface::BrickIndex, LargestDifference> shown_;  // bricks that have a surface
};

}  // namespace osteon::session
