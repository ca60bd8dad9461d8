#include "simulation/packing/surface_gaps.h"

#include <algorithm>
#include <cmath>

namespace osteon::simulation {

SurfaceGaps::SurfaceGaps(std::span<const TangentBall> samples, double first_gap_m)
    : samples_(samples), gap_m_(samples.size(), static_cast<float>(first_gap_m)) {
  Eigen::AlignedBox3d bounds;
  for (const TangentBall& sample : samples) bounds.extend(sample.foot_m);
  origin_m_ = samples.empty() ? Vector3(Vector3::Zero()) : Vector3(bounds.center());
  while (leaves_ * kLeafSamples < samples.size()) leaves_ *= 2;
  nodes_.resize(2 * leaves_);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    Node& leaf = nodes_[leaves_ + i / kLeafSamples];
    leaf.box.extend((samples[i].foot_m - origin_m_).cast<float>());
    leaf.max_m = gap_m_[i];
  }
  for (std::size_t i = leaves_ - 1; i > 0; --i) {
    nodes_[i].box = nodes_[2 * i].box.merged(nodes_[2 * i + 1].box);
    nodes_[i].max_m = std::max(nodes_[2 * i].max_m, nodes_[2 * i + 1].max_m);
  }
}

void SurfaceGaps::Add(const Ball& ball) {
  Visit(1, ball, (Vector3(ball.center_m) - origin_m_).cast<float>());
}

void SurfaceGaps::Visit(std::size_t node_index, const Ball& ball, const Eigen::Vector3f& center) {
  Node& node = nodes_[node_index];
  if (node.max_m <= 0.0f) return;
  const float reach = static_cast<float>(ball.radius_m) + node.max_m;
  if (node.box.squaredExteriorDistance(center) >= reach * reach) return;
  if (node_index < leaves_) {
    Visit(2 * node_index, ball, center);
    Visit(2 * node_index + 1, ball, center);
    node.max_m = std::max(nodes_[2 * node_index].max_m, nodes_[2 * node_index + 1].max_m);
    return;
  }
  const std::size_t begin = (node_index - leaves_) * kLeafSamples;
  const std::size_t end = std::min(begin + kLeafSamples, samples_.size());
  node.max_m = 0.0f;
  for (std::size_t i = begin; i < end; ++i) {
    const double distance = (samples_[i].foot_m - Vector3(ball.center_m)).norm() - ball.radius_m;
    gap_m_[i] = std::min(gap_m_[i], static_cast<float>(std::max(0.0, distance)));
    node.max_m = std::max(node.max_m, gap_m_[i]);
  }
}

std::vector<Ball> CoverSurface(std::span<const TangentBall> samples, std::size_t count) {
  Eigen::AlignedBox3d bounds;
  for (const TangentBall& sample : samples) bounds.extend(sample.foot_m);
  SurfaceGaps gaps(samples, samples.empty() ? 0.0 : bounds.diagonal().norm());

  struct Entry {
    float measure;
    std::uint32_t sample;
    bool operator<(const Entry& other)
        const {  // the largest measure is on top of the heap; of equal measures, the first sample
      return measure != other.measure ? measure < other.measure : sample > other.sample;
    }
  };
  const auto measure = [&](std::size_t i) -> float {
    const float gap = gaps.GapAt(i);
    if (gap <= (count == 0 ? samples[i].tolerance_m : 0.0f)) return 0.0f;
    return gap / samples[i].tolerance_m * std::sqrt(static_cast<float>(samples[i].ball.radius_m));
  };
  std::vector<Entry> heap(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i)
    heap[i] = {.measure = measure(i), .sample = static_cast<std::uint32_t>(i)};
  std::make_heap(heap.begin(), heap.end());

  // Gaps only shrink, so measures in the heap may be out of date, but never too small. If the top entry's
  // measure is current, it is the largest.
  std::vector<Ball> balls;
  while (!heap.empty() && (count == 0 || balls.size() < count)) {
    std::pop_heap(heap.begin(), heap.end());
    Entry& top = heap.back();
    const float current = measure(top.sample);
    if (current > 0.0f && current < top.measure) {
      top.measure = current;
      std::push_heap(heap.begin(), heap.end());
      continue;
    }
    if (current > 0.0f) {
      balls.push_back(samples[top.sample].ball);
      gaps.Add(balls.back());
    }
    heap.pop_back();
  }
  return balls;
}

}  // namespace osteon::simulation
