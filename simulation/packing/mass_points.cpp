#include "simulation/packing/mass_points.h"

#include <atomic>
#include <cmath>
#include <limits>
#include <span>

#include "base/check_range.h"
#include "base/parallel.h"
#include "base/scramble.h"
#include "simulation/packing/cell_lookup.h"
#include "simulation/packing/morton.h"

namespace osteon::simulation {
namespace {

// different salts, so that the random numbers of the samples and of the cells' order are independent
constexpr std::uint64_t kSampleSalt = 16, kOrderSalt = 17;
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
// in separations: a point is added where all points are farther away than this
constexpr double kMaxHole = 1.5;
constexpr double kShareReach = 2.3;  // in separations: radius of the search for the sites of a slab
constexpr double kSlab = 0.2;        // in sides of a cell: thickness of a slab
constexpr double kByZone = 8.0;      // in sides of a cell: largest depth at which slabs follow the cut zone

/// A site: a place that becomes a mass point. The sites of a cell form a linked list.
struct Site {
  Vector3 p_m;
  std::uint32_t cell, next;
};

/// Linear approximation of the depth within a cell: the depth at a point, and its gradient.
struct DepthPlane {
  bool below_zone;  ///< true: depth below the cut zone; false: below the surface
  Vector3 p_m;
  double depth_m;
  Vector3 gradient;
  [[nodiscard]] double At(const Vector3& at_m) const { return depth_m + gradient.dot(at_m - p_m); }
};

/// Properties of a site that determine which samples the site gets.
struct SiteTraits {
  MaterialIndex material;
  double below_zone_m, below_surface_m;
  double weight_per_m2;  ///< 1/side^2 of its cell: distances are compared in units of the site's own spacing
};

/// The steps of BuildMassPoints: draws sites, then assigns samples to sites. Each site with its samples
/// becomes a mass point.
class Builder {
 public:
  Builder(const Solid& solid, const CutZone& zone, const MassPointParams& params)
      : solid_(solid),
        zone_(zone),
        params_(params),
        cells_(DivideGraded(solid, zone, params.cells, CellChoice::kSolid)),
        lookup_(cells_),
        samples_(params.samples_along_axis * params.samples_along_axis * params.samples_along_axis) {}

  std::vector<MassPoint> Build() {
    FindSamplesInside();
    DrawSites();
    DescribeSites();
    ShareVolume();
    std::vector<MassPoint> points(sites_.size());
    const double unit = std::pow(params_.cells.finest_m / params_.samples_along_axis, 3);
    for (std::size_t i = 0; i < points.size(); ++i)
      points[i] = {.p_m = sites_[i].p_m,
                   .volume_m3 = unit * static_cast<double>(shares_[i]),
                   .material = traits_[i].material};
    // drop points without volume: a point between others of its slab may be nearest to no sample
    std::erase_if(points, [](const MassPoint& point) { return point.volume_m3 == 0.0; });
    SortAlongMortonCurve(points, solid_.Bounds(), [](const MassPoint& point) { return Vector3(point.p_m); });
    return points;
  }

 private:
  /// Sample i of a cell: a random place in the i-th of the cell's n^3 equal parts.
  [[nodiscard]] Vector3 SampleOf(const Cell& cell, std::uint64_t cell_bits, int i) const {
    const int n = params_.samples_along_axis;
    Vector3 in_cell(i % n, i / n % n, i / (n * n));
    for (int axis = 0; axis < 3; ++axis)
      in_cell[axis] += Uniform(MixBits((cell_bits + 3 * i + axis) * kSplitMixStep));
    return cell.min_corner() + cell.side_m / n * in_cell;
  }
  /// Random bits for a cell's samples.
  [[nodiscard]] static std::uint64_t BitsOf(const Cell& cell) {
    return CellRandom(cell, kSampleSalt).NextBits();
  }
  /// Writes all samples of a cell into `samples`.
  void SamplesOf(const Cell& cell, std::vector<Vector3>& samples) const {
    const std::uint64_t bits = BitsOf(cell);
    samples.resize(samples_);
    for (int i = 0; i < samples_; ++i) samples[i] = SampleOf(cell, bits, i);
  }

  /// Finds which samples lie in the solid, for all cells that the solid's surface may cross.
  void FindSamplesInside() {
    crossed_.resize(cells_.size(), kNone);
    std::vector<std::uint32_t> crossed;
    for (std::uint32_t i = 0; i < cells_.size(); ++i) {
      if (cells_[i].signed_distance_m <= -cells_[i].reach_m()) continue;
      crossed_[i] = static_cast<std::uint32_t>(crossed.size());
      crossed.push_back(i);
    }
    inside_.resize(crossed.size() * samples_);
    ParallelFor(crossed.size(), params_.threads, [&](std::size_t begin, std::size_t end) {
      std::vector<Vector3> samples;
      for (std::size_t c = begin; c < end; ++c) {
        SamplesOf(cells_[crossed[c]], samples);
        FindInside(cells_[crossed[c]], samples, &inside_[c * samples_]);
      }
    });
  }

  /// Finds which samples of a cell are inside the solid, with few distance queries, because these are slow on
  /// meshes. If a sample is nearer to the centre of its cell or octant than this centre is to the surface,
  /// sample and centre are on the same side of the surface.
  void FindInside(const Cell& cell, const std::vector<Vector3>& samples, char* inside) const {
    const Vector3 center = cell.center();
    std::array<double, 8> of_octant{};
    of_octant.fill(std::numeric_limits<double>::quiet_NaN());
    for (int i = 0; i < samples_; ++i) {
      const Vector3 from_center = samples[i] - center;
      if (from_center.norm() < std::abs(cell.signed_distance_m)) {
        inside[i] = cell.signed_distance_m < 0.0;
        continue;
      }
      const int octant =
          (from_center.x() > 0.0) | (from_center.y() > 0.0) << 1 | (from_center.z() > 0.0) << 2;
      const Vector3 to_octant =
          0.25 * cell.side_m * Vector3(octant & 1 ? 1 : -1, octant & 2 ? 1 : -1, octant & 4 ? 1 : -1);
      double& distance = of_octant[octant];
      if (std::isnan(distance)) distance = solid_.SignedDistance(center + to_octant);
      const bool known = (from_center - to_octant).norm() < std::abs(distance);
      inside[i] = (known ? distance : solid_.SignedDistance(samples[i])) < 0.0;
    }
  }

  /// True if this sample of the cell lies in the solid.
  [[nodiscard]] bool Inside(std::uint32_t cell, int sample) const {
    return crossed_[cell] == kNone || inside_[static_cast<std::size_t>(crossed_[cell]) * samples_ + sample];
  }

  /// Calls visit(site, squared reach) for the sites nearer to the cell than `factor` separations.
  template <typename Visit>
  void ForEachSiteNear(const Cell& cell, double factor, const Visit& visit) const {
    const Vector3 low = cell.min_corner(), high = low + Vector3::Constant(cell.side_m);
    for (int level = 0; level < lookup_.levels(); ++level) {
      const double reach = factor * 0.5 * kMassPointSeparation * (cell.side_m + lookup_.side_m(level));
      const Vector3 margin = Vector3::Constant(reach);
      lookup_.ForEachIn(level, low - margin, high + margin, [&](std::uint32_t near) {
        for (std::uint32_t i = first_site_[near]; i != kNone; i = sites_[i].next) {
          const Vector3& p = sites_[i].p_m;
          if ((p - p.cwiseMax(low).cwiseMin(high)).squaredNorm() < reach * reach) visit(i, reach * reach);
        }
      });
    }
  }

  /// Random bits of a cell. They determine the random order of the cells and of the samples within a cell.
  [[nodiscard]] static std::uint64_t OrderBits(const Cell& cell) {
    return CellRandom(cell, kOrderSalt).NextBits();
  }
  /// Cells in random order: OrderBits and index of each.
  using Order = std::vector<std::pair<std::uint64_t, std::uint32_t>>;

  /// Index of the sample that is tried as the k-th one of its cell.
  /// @param bits  the cell's OrderBits
  [[nodiscard]] int SampleToTry(std::uint64_t bits, int k) const {
    // a prime that divides no accepted n^3, so that all samples are visited
    constexpr std::uint64_t kStride = 37;
    return static_cast<int>((bits % samples_ + k * kStride) % samples_);
  }

  /// True if a site lies nearer than `factor` separations to p. @param cell  the cell that contains p
  [[nodiscard]] bool Refused(const Vector3& p, std::uint32_t cell, double factor) const {
    const auto near_in = [&](std::uint32_t other, double reach) {
      for (std::uint32_t i = first_site_[other]; i != kNone; i = sites_[i].next)
        if ((sites_[i].p_m - p).squaredNorm() < reach * reach) return true;
      return false;
    };
    const auto reach_of = [&](double side) {
      return factor * 0.5 * kMassPointSeparation * (cells_[cell].side_m + side);
    };
    if (near_in(cell, reach_of(cells_[cell].side_m)))
      return true;  // a refusal by a site of the same cell is the most likely one
    bool refused = false;
    for (int level = 0; level < lookup_.levels() && !refused; ++level) {
      const double reach = reach_of(lookup_.side_m(level));
      const Vector3 margin = Vector3::Constant(reach);
      lookup_.ForEachIn(level, p - margin, p + margin,
                        [&](std::uint32_t other) { refused = refused || near_in(other, reach); });
    }
    return refused;
  }

  /// Tries one sample of each cell, in random order of the cells. A sample becomes a site if it lies at least
  /// one separation from all sites so far. Since a sample may lie anywhere in its cell, sites do not line up
  /// with the cells.
  void DrawOnce(const Order& order, int trial) {
    for (const auto& [bits, cell] : order) {
      const Vector3 p = SampleOf(cells_[cell], BitsOf(cells_[cell]), SampleToTry(bits, trial));
      if (!Refused(p, cell, 1.0)) AddSite(p, cell);
    }
  }

  /// Makes sites of all samples that lie at least `factor` separations from all sites so far, cell by cell.
  /// First, all threads exclude the samples that earlier sites refuse: nearly all samples.
  void DrawRest(const Order& order, double factor, bool only_inside) {
    std::vector<std::vector<std::uint16_t>> candidates(cells_.size());
    ParallelFor(cells_.size(), params_.threads, [&](std::size_t begin, std::size_t end) {
      struct Neighbor {
        Vector3 p_m;
        double squared_reach_m2;
      };
      std::vector<Vector3> samples;
      std::vector<Neighbor> neighbors;
      for (auto cell = static_cast<std::uint32_t>(begin); cell < end; ++cell) {
        if (only_inside && crossed_[cell] == kNone) continue;
        const std::uint64_t bits = OrderBits(cells_[cell]);
        neighbors.clear();
        ForEachSiteNear(cells_[cell], factor, [&](std::uint32_t i, double squared_reach) {
          neighbors.push_back({sites_[i].p_m, squared_reach});
        });
        SamplesOf(cells_[cell], samples);
        std::size_t last = 0;  // the site that refused the last sample often refuses the next
        for (int k = 0; k < samples_; ++k) {
          const int i = SampleToTry(bits, k);
          if (only_inside && !Inside(cell, i)) continue;
          const auto refuses = [&p = samples[i]](const Neighbor& near) {
            return (near.p_m - p).squaredNorm() < near.squared_reach_m2;
          };
          if (last < neighbors.size() && refuses(neighbors[last])) continue;
          last = std::find_if(neighbors.begin(), neighbors.end(), refuses) - neighbors.begin();
          if (last == neighbors.size()) candidates[cell].push_back(static_cast<std::uint16_t>(i));
        }
      }
    });
    for (const auto& [bits, cell] : order)
      for (const int i : candidates[cell]) {
        const Vector3 p = SampleOf(cells_[cell], BitsOf(cells_[cell]), i);
        if (!Refused(p, cell, factor)) AddSite(p, cell);
      }
  }

  void AddSite(const Vector3& p, std::uint32_t cell) {
    sites_.push_back({.p_m = p, .cell = cell, .next = first_site_[cell]});
    first_site_[cell] = static_cast<std::uint32_t>(sites_.size() - 1);
  }

  /// Draws sites in all cells, keeps those inside the solid, and adds sites in the holes that are left.
  void DrawSites() {
    Order order(cells_.size());
    for (std::uint32_t i = 0; i < cells_.size(); ++i) order[i] = {OrderBits(cells_[i]), i};
    std::sort(order.begin(), order.end());
    first_site_.resize(cells_.size(), kNone);
    sites_.reserve(cells_.size() + cells_.size() / 4);
    constexpr int kTrials = 4;  // number of DrawOnce passes, which find most of the sites
    for (int trial = 0; trial < kTrials; ++trial) DrawOnce(order, trial);
    DrawRest(order, 1.0, false);

    std::vector<char> inside(sites_.size());
    ParallelFor(sites_.size(), params_.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        inside[i] = crossed_[sites_[i].cell] == kNone || solid_.SignedDistance(sites_[i].p_m) < 0.0;
    });
    const std::vector<Site> drawn = std::move(sites_);
    sites_.clear();
    first_site_.assign(cells_.size(), kNone);
    for (std::size_t i = 0; i < drawn.size(); ++i)
      if (inside[i]) AddSite(drawn[i].p_m, drawn[i].cell);
    DrawRest(order, kMaxHole, true);
  }

  /// Depth within a cell: below the cut zone in a finest cell near the zone, below the surface elsewhere.
  [[nodiscard]] DepthPlane PlaneIn(const Cell& cell) const {
    DepthPlane plane{.below_zone = true, .p_m = cell.center(), .depth_m = 0.0, .gradient = Vector3::Zero()};
    if (cell.level == 0) {
      plane.depth_m = zone_.DepthAt(plane.p_m);
      if (std::abs(plane.depth_m) < kByZone * cell.side_m) {
        const double step = 0.25 * cell.side_m;
        for (int axis = 0; axis < 3; ++axis)
          plane.gradient[axis] =
              (zone_.DepthAt(plane.p_m + step * Vector3::Unit(axis)) - plane.depth_m) / step;
        if (!plane.gradient.isZero()) return plane;  // the gradient is zero if the zone is everywhere
      }
    }
    plane.below_zone = false;
    SurfacePoint foot = solid_.NearestSurface(plane.p_m);
    if (std::abs(foot.distance_m) < 1e-3 * cell.side_m) {
      // The point is too close to the surface to determine the normal. Move it: in most cases, this step
      // leads far enough away.
      plane.p_m += 0.2 * cell.side_m * Vector3(0.36, 0.48, 0.8);
      foot = solid_.NearestSurface(plane.p_m);
    }
    plane.depth_m = -foot.distance_m;
    if (foot.distance_m != 0.0) plane.gradient = (foot.p_m - plane.p_m) / foot.distance_m;
    return plane;
  }

  /// Finds tissue and depths at the sites, and the depth that is used in each cell (PlaneIn).
  void DescribeSites() {
    planes_.resize(cells_.size());
    ParallelFor(cells_.size(), params_.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) planes_[i] = PlaneIn(cells_[i]);
    });
    traits_.resize(sites_.size());
    ParallelFor(sites_.size(), params_.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Vector3& p = sites_[i].p_m;
        const double side = cells_[sites_[i].cell].side_m;
        traits_[i] = {.material = solid_.MaterialAt(p),
                      .below_zone_m = zone_.DepthAt(p),
                      .below_surface_m = -solid_.SignedDistance(p),
                      .weight_per_m2 = 1.0 / (side * side)};
      }
    });
  }

  /// Assigns each sample's volume to a site, in units of the volume of a sample in the finest cells. These
  /// are whole numbers, so the sums do not depend on the order of the threads.
  void ShareVolume() {
    std::vector<std::atomic<std::uint64_t>> shares(sites_.size());
    ParallelFor(cells_.size(), params_.threads, [&](std::size_t begin, std::size_t end) {
      Sharing sharing(*this);
      std::vector<Vector3> samples;
      for (auto cell = static_cast<std::uint32_t>(begin); cell < end; ++cell) {
        if (!sharing.Enter(cell)) continue;
        SamplesOf(cells_[cell], samples);
        for (int i = 0; i < samples_; ++i)
          if (Inside(cell, i))
            shares[sharing.SiteOf(samples[i])].fetch_add(std::uint64_t{1} << (3 * cells_[cell].level),
                                                         std::memory_order_relaxed);
      }
    });
    shares_.assign(shares.begin(), shares.end());
  }

  /// Finds the sites to which the samples of a cell are assigned.
  class Sharing {
   public:
    explicit Sharing(const Builder& builder) : b_(builder) {}

    /// Gathers the sites around a cell, sorted by slab. @returns false if there is no site: then no sample is
    /// inside the solid.
    bool Enter(std::uint32_t index) {
      const Cell& cell = b_.cells_[index];
      plane_ = b_.planes_[index];
      thickness_m_ = kSlab * cell.side_m;
      // the slabs that the cell covers, by its range of depths
      const double half = 0.5 * cell.side_m * plane_.gradient.lpNorm<1>();
      const double middle = plane_.At(cell.center());
      first_slab_ = Slab(middle - half);
      slabs_ = Slab(middle + half) - first_slab_ + 1;
      near_.clear();
      begins_.assign(slabs_ + 1, 0);
      b_.ForEachSiteNear(cell, kShareReach, [&](std::uint32_t i, double) {
        const SiteTraits& traits = b_.traits_[i];
        const double depth = plane_.below_zone ? traits.below_zone_m : traits.below_surface_m;
        const int slab = Slab(depth) - first_slab_;
        const bool within = slab >= 0 && slab < slabs_;
        near_.push_back(
            {b_.sites_[i].p_m, depth, traits.weight_per_m2, i, within ? slab : -1, traits.material});
        if (within) ++begins_[slab + 1];
      });
      // counting sort of the sites by slab
      for (int slab = 0; slab < slabs_; ++slab) begins_[slab + 1] += begins_[slab];
      ends_.assign(begins_.begin(), begins_.end() - 1);
      by_slab_.resize(begins_.back());
      for (const Near& near : near_)
        if (near.slab >= 0) by_slab_[ends_[near.slab]++] = near;
      // If a border between two tissues lies within a slab, the sites of the slab and its neighbours have
      // different materials.
      mixed_.assign(slabs_, 0);
      for (int slab = 0; slab < slabs_; ++slab) {
        const int from = begins_[std::max(slab - 1, 0)], to = begins_[std::min(slab + 2, slabs_)];
        for (int i = from + 1; i < to; ++i)
          if (by_slab_[i].material != by_slab_[from].material) mixed_[slab] = 1;
      }
      return !near_.empty();
    }

    /// The site that gets the sample at p: the nearest site of the same material in the same slab. If there
    /// is none, the nearest one with about the same depth.
    [[nodiscard]] std::uint32_t SiteOf(const Vector3& p) const {
      const double depth = plane_.At(p);
      const int slab = std::clamp(Slab(depth) - first_slab_, 0, slabs_ - 1);
      const std::span<const Near> in_slab(by_slab_.data() + begins_[slab], begins_[slab + 1] - begins_[slab]);
      const auto any = [](const Near&) { return true; };
      const auto distance_to = [&p](const Near& near) {
        return near.weight_per_m2 * (near.p_m - p).squaredNorm();
      };
      // query the material only if it matters, because the query is slow
      if (!in_slab.empty() && !mixed_[slab]) return Nearest(in_slab, distance_to, any);
      const MaterialIndex material = b_.solid_.MaterialAt(p);
      const auto same = [material](const Near& near) { return near.material == material; };
      std::uint32_t site = Nearest(in_slab, distance_to, same);
      if (site != kNone) return site;
      // no such site in the slab: choose one of about the same depth
      const auto distance_with_depth = [&](const Near& near) {
        // weight of a difference in depth, relative to a distance along the slab
        constexpr double kDepthCounts = 10.0;
        const double depth_off = kDepthCounts * (near.depth_m - depth);
        return distance_to(near) + near.weight_per_m2 * depth_off * depth_off;
      };
      site = Nearest(near_, distance_with_depth, same);
      return site != kNone ? site : Nearest(near_, distance_with_depth, any);
    }

   private:
    struct Near {
      Vector3 p_m;
      double depth_m, weight_per_m2;
      std::uint32_t site;
      int slab;  ///< number of the slab, counted from the cell's first one; -1: in none of the cell's slabs
      MaterialIndex material;
    };
    /// Number of the slab at this depth.
    [[nodiscard]] int Slab(double depth_m) const {
      return static_cast<int>(std::floor(depth_m / thickness_m_));
    }
    /// The nearest accepted site; kNone if no site is accepted.
    template <typename Distance, typename Accept>
    static std::uint32_t Nearest(std::span<const Near> of, const Distance& distance, const Accept& accept) {
      double min_distance = std::numeric_limits<double>::infinity();
      std::uint32_t site = kNone;
      for (const Near& near : of) {
        if (!accept(near)) continue;
        const double d = distance(near);
        if (d >= min_distance) continue;
        min_distance = d;
        site = near.site;
      }
      return site;
    }

    const Builder& b_;
    DepthPlane plane_{};
    double thickness_m_{0.0};
    int first_slab_{0}, slabs_{0};
    std::vector<Near> near_, by_slab_;
    std::vector<int> begins_, ends_;
    /// For each slab: 1 if the sites of the slab and its neighbours have different materials
    std::vector<char> mixed_;
  };

  const Solid& solid_;
  const CutZone& zone_;
  const MassPointParams& params_;
  std::vector<Cell> cells_;
  CellLookup lookup_;
  int samples_;
  std::vector<std::uint32_t> crossed_;     ///< for each cell, its index among the crossed ones; kNone: all
                                           ///< inside
  std::vector<char> inside_;               ///< for each sample of the crossed cells: 1 if inside
  std::vector<DepthPlane> planes_;         ///< for each cell
  std::vector<std::uint32_t> first_site_;  ///< for each cell, the head of its list of sites
  std::vector<Site> sites_;
  std::vector<SiteTraits> traits_;     ///< for each site
  std::vector<std::uint64_t> shares_;  ///< for each site, its volume in units of ShareVolume
};

}  // namespace

std::vector<MassPoint> BuildMassPoints(const Solid& solid, const CutZone& zone,
                                       const MassPointParams& params) {
  CheckGrade("mass points: cells", params.cells, 0.1e-3, 0.050);
  if (params.samples_along_axis < 2 || params.samples_along_axis > 16)
    throw std::invalid_argument(fmt::format("mass points: samples along an axis: found {}, accepted 2 … 16",
                                            params.samples_along_axis));
  return Builder(solid, zone, params).Build();
}

}  // namespace osteon::simulation
