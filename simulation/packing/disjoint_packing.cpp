#include "simulation/packing/disjoint_packing.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <compare>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include "base/check_range.h"
#include "base/parallel.h"
#include "base/scramble.h"
#include "simulation/packing/hole_search.h"
#include "simulation/packing/morton.h"
#include "simulation/packing/packing_builder.h"

namespace osteon::simulation {
namespace {

/// Holes that are not filled yet are sorted into classes by radius. This is the ratio of the smallest to the
/// largest radius in a class.
constexpr double kClassRatio = 0.95;

/// Subtracted from each radius, so that rounding does not produce overlaps.
constexpr double kGuard_m = 1e-12;

/// Builds one disjoint packing: collects holes, and fills them from the largest class down.
class Packer {
 public:
  Packer(const Solid& solid, const CutZone& zone, const DisjointParams& params)
      : solid_(solid),
        params_(params),
        cap_{.zone = zone, .radius_m = params.max_radius_m, .grade = params.grade},
        // for few balls, a coarse grid of depths is enough
        depths_(solid, params.count > 0 && params.count < 20'000 ? 64 : 128, params.threads),
        balls_(solid.Bounds().center()),
        min_m_(params.min_radius_m),
        limit_m_(depths_.spacing_m()) {}

  std::vector<Ball> Build() {
    const std::vector<Vector3> starts = depths_.LocalMaxima();
    Search(starts.size(), [&](HoleSearch& search, std::size_t i, std::vector<Ball>& found) {
      found.push_back(search.From(starts[i], depths_.spacing_m(), min_m_));
    });
    while (!Full()) {
      // if holes of the current size were dropped, or no hole is left, search the whole solid for holes
      if (limit_m_ < dropped_m_ || holes_.empty()) {
        if (!SearchEverywhere() && holes_.empty()) break;
      }
      FillLargest();
    }
    std::vector<Ball> result = balls_.balls();
    SortAlongMortonCurve(result, solid_.Bounds(), [](const Ball& ball) { return Vector3(ball.center_m); });
    return result;
  }

 private:
  [[nodiscard]] bool Full() const { return params_.count > 0 && balls_.balls().size() >= params_.count; }

  /// Calls find(search, i, found) in parallel for i = 0 … count - 1, and stores the holes that were found, in
  /// the order of i.
  template <typename Find>
  void Search(std::size_t count, const Find& find) {
    constexpr std::size_t kChunk = 16;
    std::vector<std::vector<Ball>> found((count + kChunk - 1) / kChunk);
    ParallelFor(
        count, params_.threads,
        [&](std::size_t begin, std::size_t end) {
          HoleSearch search(solid_, depths_, balls_, cap_, params_.seed);
          for (std::size_t i = begin; i < end; ++i) find(search, i, found[begin / kChunk]);
        },
        kChunk);
    for (const std::vector<Ball>& some : found)
      for (const Ball& hole : some)
        if (hole.radius_m >= min_m_) holes_[ClassOf(hole.radius_m)].push_back(hole);
  }

  /// Number of the class of holes with this radius; larger radii have larger numbers.
  [[nodiscard]] static int ClassOf(double radius_m) {
    return static_cast<int>(std::floor(std::log(radius_m) / -std::log(kClassRatio)));
  }

  /// Order of a hole within its class.
  struct FillOrder {
    int capped_first{0};  ///< 0: the cap limits the hole's radius; 1: obstacles limit it
    double key{0.0};  ///< holes limited by the cap: height z, lower ones first; other holes: -radius, larger
                      ///< ones first
    std::uint64_t tie{0};
    std::size_t index{0};
    auto operator<=>(const FillOrder&) const = default;
  };

  /// Removes the holes to be filled next from the largest class, and returns them in the order of filling.
  std::vector<Ball> TakeLargest() {
    const auto largest = std::prev(holes_.end());
    limit_m_ = std::pow(kClassRatio, -(largest->first + 1));
    std::vector<Ball> holes = std::move(largest->second);
    largest->second.clear();
    std::vector<FillOrder> orders(holes.size());
    ParallelFor(holes.size(), params_.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) orders[i] = OrderOf(holes[i], i);
    });
    std::sort(orders.begin(), orders.end());
    // Balls that the cap limits are piled up from below. If each ball rests on placed balls, the packing is
    // much denser than if balls are placed everywhere at once (in the hip bone with a cap of 2 mm: 0.56 of
    // the volume instead of 0.44).
    const bool piled = orders.front().capped_first == 0;
    // while piling, take only the lowest layer of capped holes, whose height is the largest radius of the
    // class
    const double top = orders.front().key + limit_m_;
    std::vector<Ball> taken;
    for (const FillOrder& order : orders)
      (piled && (order.capped_first > 0 || order.key > top) ? largest->second : taken)
          .push_back(holes[order.index]);
    if (largest->second.empty()) holes_.erase(largest);
    return taken;
  }

  [[nodiscard]] FillOrder OrderOf(const Ball& hole, std::size_t index) const {
    const bool capped = cap_.radius_m < limit_m_ && hole.radius_m > (1.0 - 1e-6) * cap_.At(hole.center_m);
    std::uint64_t tie = params_.seed;
    for (const double x : {hole.center_m.x, hole.center_m.y, hole.center_m.z})
      tie = Scramble(tie ^ std::bit_cast<std::uint64_t>(x));
    return {capped ? 0 : 1, capped ? hole.center_m.z : -hole.radius_m, tie, index};
  }

  /// One round: fills those holes of the largest class that are still free, and searches for the holes that
  /// remain beside them.
  void FillLargest() {
    const std::vector<Ball> holes = TakeLargest();
    std::vector<char> is_free(holes.size());
    ParallelFor(holes.size(), params_.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) is_free[i] = IsFree(holes[i]);
    });

    const std::size_t first = balls_.balls().size();
    std::vector<Ball> cut;
    for (std::size_t i = 0; i < holes.size(); ++i) {
      const Ball& hole = holes[i];
      if (is_free[i] && IsFree(hole)) {
        balls_.Insert({.center_m = hole.center_m, .radius_m = hole.radius_m - kGuard_m});
        if (Full()) return;
      } else {
        cut.push_back(hole);
      }
    }

    EstimateMinRadius();
    Search(balls_.balls().size() - first, [&](HoleSearch& search, std::size_t i, std::vector<Ball>& found) {
      search.AroundBall(first + i, min_m_, limit_m_, found);
    });
    Search(cut.size(), [&](HoleSearch& search, std::size_t i, std::vector<Ball>& found) {
      const Ball& hole = cut[i];
      // Most of this hole is filled. The rest of it lies beside the ball that fills it, where AroundBall
      // searches.
      if (balls_.Clearance(hole.center_m, hole.radius_m) < -0.5 * hole.radius_m) return;
      found.push_back(search.From(hole.center_m, 0.5 * hole.radius_m, min_m_));
    });
  }

  /// True if the hole's ball overlaps no placed ball.
  [[nodiscard]] bool IsFree(const Ball& hole) const {
    return balls_.Clearance(hole.center_m, hole.radius_m) >= hole.radius_m - kGuard_m;
  }

  /// Estimates the smallest radius that is needed (min_m_). If the number of balls is given, holes much
  /// smaller than the last ball need not be stored. The number of balls larger than r is about proportional
  /// to r^-2.4 (measured; 2.47 for Apollonian packings), which predicts the radius of the last ball.
  void EstimateMinRadius() {
    if (params_.count == 0) return;
    const double share = static_cast<double>(balls_.balls().size()) / static_cast<double>(params_.count);
    min_m_ = std::max(params_.min_radius_m, 0.5 * limit_m_ * std::pow(share, 1.0 / 2.4));
    dropped_m_ = std::max(dropped_m_, min_m_ > params_.min_radius_m ? min_m_ : 0.0);
  }

  /// Searches the whole solid for missed holes, starting with the largest radii that may have been missed.
  /// @returns whether there is any hole
  bool SearchEverywhere() {
    const Eigen::AlignedBox3d box = solid_.Bounds();
    const double side = 4.0 * depths_.spacing_m();
    std::array<std::size_t, 3> count{};
    for (int axis = 0; axis < 3; ++axis) count[axis] = static_cast<std::size_t>(box.sizes()[axis] / side) + 1;
    const std::size_t cubes = count[0] * count[1] * count[2];
    // start with holes of nearly the current size; as long as none is found, search for smaller ones
    while (true) {
      min_m_ = std::max(params_.min_radius_m, 0.7 * limit_m_);
      dropped_m_ = min_m_ > params_.min_radius_m ? min_m_ : 0.0;
      if (min_m_ != searched_m_) has_holes_.assign(cubes, 1);
      searched_m_ = min_m_;
      Search(cubes, [&](HoleSearch& search, std::size_t i, std::vector<Ball>& found) {
        if (!has_holes_[i]) return;
        const std::size_t before = found.size();
        const Eigen::Array3d at =
            Eigen::Array<std::size_t, 3, 1>(i % count[0], i / count[0] % count[1], i / count[0] / count[1])
                .cast<double>();
        search.InCube(box.min() + side * (at + 0.5).matrix(), side, min_m_, found);
        has_holes_[i] = found.size() > before;
      });
      if (!holes_.empty()) return true;
      if (min_m_ == params_.min_radius_m) return false;
      limit_m_ = min_m_;
    }
  }

  const Solid& solid_;
  const DisjointParams& params_;
  const RadiusCap cap_;
  const DistanceGrid depths_;
  BallGrid balls_;
  std::map<int, std::vector<Ball>> holes_;  ///< holes by class, the largest last

  double min_m_;           ///< smaller holes are dropped
  double dropped_m_{0.0};  ///< holes of up to this radius may have been dropped
  double limit_m_;         ///< largest radius of the class that was filled last

  /// For each cube of SearchEverywhere: whether it may have a hole of searched_m_
  std::vector<char> has_holes_;
  double searched_m_{0.0};
};

void Check(const DisjointParams& p) {
  if (p.count > kMaxBalls)
    throw std::invalid_argument(
        fmt::format("disjoint packing: count: found {}, accepted 0 … {}", p.count, kMaxBalls));
  CheckRangeMm("disjoint packing: least radius", p.min_radius_m, 0.001e-3, 0.1);
  CheckRangeMm("disjoint packing: greatest radius", p.max_radius_m, p.min_radius_m, 1.0);
  if (!(p.grade >= 0.0 && p.grade <= 1.0))
    throw std::invalid_argument(fmt::format("disjoint packing: grade: found {:g}, accepted 0 … 1", p.grade));
  if (p.threads < 0 || p.threads > 1024)
    throw std::invalid_argument(
        fmt::format("disjoint packing: threads: found {}, accepted 0 … 1024", p.threads));
}

}  // namespace

std::vector<Ball> BuildDisjointPacking(const Solid& solid, const CutZone& zone,
                                       const DisjointParams& params) {
  Check(params);
  return Packer(solid, zone, params).Build();
}

}  // namespace osteon::simulation
