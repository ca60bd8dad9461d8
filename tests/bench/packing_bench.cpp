// Measures how long a packing file takes to open: osteon_packing_bench FILE [BALLS [POINTS]]
//
// Writes a synthetic packing of that size to FILE, then opens it (maps it, verifies every checksum, checks
// every value) ten times. Prints wall and processor time of each opening and their medians.

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "simulation/packing/packing_file.h"

namespace {

using namespace osteon::simulation;

double Seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

double ProcessorSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return Seconds(usage.ru_utime) + Seconds(usage.ru_stime);
}

double WallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Random spheres and mass points in a cube of 0.2 m.
Bone Synthetic(std::size_t balls, std::size_t points) {
  std::uint64_t state = 1;
  const auto uniform = [&state](double low, double high) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * static_cast<double>(state >> 11) * 0x1.0p-53;
  };
  Bone bone{.name = "synthetic", .balls = {}, .points = {}, .materials = DefaultBoneMaterials(), .site = {}};
  bone.balls.resize(balls);
  for (Ball& ball : bone.balls)
    ball = {.center_m = osteon::Vector3(uniform(-0.1, 0.1), uniform(-0.1, 0.1), uniform(-0.1, 0.1)),
            .radius_m = uniform(0.05e-3, 0.5e-3)};
  bone.points.resize(points);
  for (MassPoint& point : bone.points)
    point = {.p_m = osteon::Vector3(uniform(-0.1, 0.1), uniform(-0.1, 0.1), uniform(-0.1, 0.1)),
             .volume_m3 = uniform(0.1e-9, 1e-9),
             .material = static_cast<MaterialIndex>(state % 3)};
  return bone;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "osteon_packing_bench FILE [BALLS [POINTS]]\n");
    return 2;
  }
  // the i-th argument as a number, or `otherwise` if it is missing
  const auto number = [&](int i, std::size_t otherwise) {
    return argc > i ? static_cast<std::size_t>(std::strtoull(argv[i], nullptr, 10)) : otherwise;
  };
  const std::size_t balls = number(2, 10'000'000), points = number(3, 2'000'000);
  {
    const Bone bone = Synthetic(balls, points);
    const double begin = WallSeconds();
    const auto written = WritePackingFile(argv[1], bone, {.program = "osteon_packing_bench"});
    if (!written) {
      std::fprintf(stderr, "osteon_packing_bench: %s\n", written.error().Text().c_str());
      return 1;
    }
    std::printf("written: %zu balls, %zu points, %.2f s\n", balls, points, WallSeconds() - begin);
  }
  std::vector<double> wall, processor;
  for (int i = 0; i < 10; ++i) {
    const double begin = WallSeconds(), spent = ProcessorSeconds();
    const auto file = PackingFile::Open(argv[1]);
    if (!file || file->balls().size() != balls || file->points().size() != points) {
      std::fprintf(stderr, "osteon_packing_bench: %s\n", file ? "other sizes" : file.error().Text().c_str());
      return 1;
    }
    wall.push_back(WallSeconds() - begin);
    processor.push_back(ProcessorSeconds() - spent);
    std::printf("opened: %.3f s, processor %.3f s\n", wall.back(), processor.back());
  }
  for (auto* list : {&wall, &processor}) std::ranges::sort(*list);
  std::printf("median: %.3f s, processor %.3f s\n", wall[5], processor[5]);
  return 0;
}
