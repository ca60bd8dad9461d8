#include "simulation/mesh/mesh_polygons.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace osteon::simulation {
namespace {

// limit, because the search for ears takes at least quadratic time
constexpr std::size_t kMaxConcaveCorners = 1024;

using Point2 = std::array<double, 2>;

/// Twice the signed area of a triangle.
double Area2(const Point2& a, const Point2& b, const Point2& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Divides one polygon at a time into triangles; reuses its memory between polygons.
class PolygonTriangulator {
 public:
  PolygonTriangulator(const PolygonMesh& mesh, RawMesh& raw) : mesh_(mesh), raw_(raw) {}

  /// @returns why the polygon is refused; empty if it is accepted.
  std::string Triangulate(const std::uint32_t* corners, std::size_t count, std::uint32_t part) {
    part_ = part;
    ring_.clear();
    for (std::size_t i = 0; i < count; ++i)
      if (ring_.empty() || ring_.back() != corners[i]) ring_.push_back(corners[i]);
    while (ring_.size() > 1 && ring_.back() == ring_.front()) ring_.pop_back();
    if (ring_.size() < 3) {
      Add(ring_.front(), ring_.back(), ring_.front());
      return {};
    }
    if (ring_.size() == 3) {
      Add(ring_[0], ring_[1], ring_[2]);
      return {};
    }
    sorted_ = ring_;
    std::sort(sorted_.begin(), sorted_.end());
    if (std::adjacent_find(sorted_.begin(), sorted_.end()) != sorted_.end())
      return "found a polygon that visits a vertex twice (around a hole?), accepted simple polygons";
    if (!Project() || FanIsSound()) {
      for (std::size_t i = 1; i + 1 < ring_.size(); ++i) Add(ring_[0], ring_[i], ring_[i + 1]);
      return {};
    }
    if (ring_.size() > kMaxConcaveCorners)
      return fmt::format("found a concave polygon of {} corners, accepted up to {}", ring_.size(),
                         kMaxConcaveCorners);
    return CutEars() ? std::string() : "found a polygon that crosses itself, accepted simple polygons";
  }

 private:
  /// Adds a triangle to the result.
  void Add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    raw_.triangles.push_back({mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]});
    raw_.part_of_triangle.push_back(part_);
  }

  /// Projects the corners along the largest component of the mean normal (Newell), so that they run
  /// counter-clockwise.
  /// @returns false if the polygon has no area.
  bool Project() {
    std::array<double, 3> normal{};
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const auto& a = mesh_.vertices[ring_[i]];
      const auto& b = mesh_.vertices[ring_[(i + 1) % ring_.size()]];
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t u = (k + 1) % 3, v = (k + 2) % 3;
        normal[k] += (double{a[u]} - b[u]) * (double{a[v]} + b[v]);
      }
    }
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
    if (normal[axis] == 0.0) return false;
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    flat_.clear();
    for (const std::uint32_t corner : ring_) {
      const auto& p = mesh_.vertices[corner];
      flat_.push_back(normal[axis] > 0.0 ? Point2{p[u], p[v]} : Point2{p[v], p[u]});
    }
    return true;
  }

  /// Whether all triangles from the first corner run counter-clockwise.
  [[nodiscard]] bool FanIsSound() const {
    for (std::size_t i = 1; i + 1 < flat_.size(); ++i)
      if (!(Area2(flat_[0], flat_[i], flat_[i + 1]) > 0.0)) return false;
    return true;
  }

  /// Whether the triangle of corner k of `left_` and its neighbours `before` and `after` holds no other
  /// corner, inside or on its border.
  [[nodiscard]] bool IsEar(std::size_t before, std::size_t k, std::size_t after) const {
    const Point2 &a = flat_[left_[before]], &b = flat_[left_[k]], &c = flat_[left_[after]];
    for (std::size_t i = 0; i < left_.size(); ++i) {
      if (i == before || i == k || i == after) continue;
      const Point2& p = flat_[left_[i]];
      if (p == a || p == b || p == c) continue;
      if (Area2(a, b, p) >= 0.0 && Area2(b, c, p) >= 0.0 && Area2(c, a, p) >= 0.0) return false;
    }
    return true;
  }

  /// Divides a concave polygon by ear clipping. An ear without area is only cut off if there is no other ear.
  /// @returns false if the polygon has no ear.
  bool CutEars() {
    left_.resize(ring_.size());
    for (std::size_t i = 0; i < left_.size(); ++i) left_[i] = i;
    std::size_t from = 0;
    while (left_.size() > 3) {
      const std::size_t n = left_.size();
      std::size_t ear = n;
      for (const bool flat_too : {false, true}) {
        for (std::size_t step = 0; step < n && ear == n; ++step) {
          const std::size_t k = (from + step) % n, before = (k + n - 1) % n, after = (k + 1) % n;
          const double area = Area2(flat_[left_[before]], flat_[left_[k]], flat_[left_[after]]);
          if ((area > 0.0 && IsEar(before, k, after)) || (flat_too && area == 0.0)) ear = k;
        }
        if (ear < n) break;
      }
      if (ear == n) return false;
      Add(ring_[left_[(ear + n - 1) % n]], ring_[left_[ear]], ring_[left_[(ear + 1) % n]]);
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(ear));
      from = ear % left_.size();
    }
    Add(ring_[left_[0]], ring_[left_[1]], ring_[left_[2]]);
    return Area2(flat_[left_[0]], flat_[left_[1]], flat_[left_[2]]) >= 0.0;
  }

  const PolygonMesh& mesh_;
  RawMesh& raw_;
  std::uint32_t part_{0};
  std::vector<std::uint32_t> ring_, sorted_;  // the polygon's vertices without repetitions; the same, sorted
  std::vector<Point2> flat_;                  // projected corners of ring_
  std::vector<std::size_t> left_;             // indices in ring_ of the corners that are not cut off yet
};

/// True if the bytes are UTF-8, by the table of well-formed sequences (The Unicode Standard, table 3-7).
bool IsUtf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i]);
    if (first < 0x80) {
      ++i;
      continue;
    }
    const std::size_t length = first >= 0xc2 && first <= 0xdf   ? 2
                               : first >= 0xe0 && first <= 0xef ? 3
                               : first >= 0xf0 && first <= 0xf4 ? 4
                                                                : 0;
    if (length == 0 || i + length > text.size()) return false;
    for (std::size_t k = 1; k < length; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      unsigned char low = 0x80, high = 0xbf;
      if (k == 1 && first == 0xe0) low = 0xa0;
      if (k == 1 && first == 0xed) high = 0x9f;
      if (k == 1 && first == 0xf0) low = 0x90;
      if (k == 1 && first == 0xf4) high = 0x8f;
      if (next < low || next > high) return false;
    }
    i += length;
  }
  return true;
}

/// The name in UTF-8. A name that is not valid UTF-8 is read as Latin-1.
std::string AsUtf8(std::string_view name) {
  if (IsUtf8(name)) return std::string(name);
  std::string text;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      text += c;
    } else {
      text += static_cast<char>(0xc0 | byte >> 6);
      text += static_cast<char>(0x80 | (byte & 0x3f));
    }
  }
  return text;
}

}  // namespace

std::optional<PolygonError> TriangulatePolygons(const PolygonMesh& mesh, RawMesh& raw) {
  PolygonTriangulator triangulator(mesh, raw);
  raw.triangles.reserve(mesh.polygons.size());
  raw.part_of_triangle.reserve(mesh.polygons.size());
  const std::uint32_t* corners = mesh.corners.data();
  for (const PolygonMesh::Polygon& polygon : mesh.polygons) {
    std::string what = triangulator.Triangulate(corners, polygon.corners, polygon.part);
    if (!what.empty()) return PolygonError{.place = polygon.place, .what = std::move(what)};
    corners += polygon.corners;
  }
  return std::nullopt;
}

std::uint32_t PartNames::NumberOf(std::string_view name) {
  const auto [at, is_new] = numbers_.try_emplace(AsUtf8(name), static_cast<std::uint32_t>(names_.size()));
  if (is_new) names_.push_back(at->first);
  return at->second;
}

}  // namespace osteon::simulation
