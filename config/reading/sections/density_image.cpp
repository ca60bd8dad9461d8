#include "config/reading/sections/density_image.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <limits>
#include <string_view>

#include <fmt/format.h>
#include <png.h>

namespace osteon::config {
namespace {

constexpr std::uintmax_t kMaxImageBytes = 64u << 20u;  // bytes: more than 4096 × 4096 samples of 16 bits need
constexpr std::uint32_t kMaxSamples = 4096;            // largest width and height
constexpr std::uint32_t kMinRows = 2;                  // smallest height
constexpr double kDensest_g_per_cm3 = 25.0;            // largest density that a file may give
constexpr const char* kAccepted = "accepted a grey PNG without transparency";

using Bytes = std::vector<std::uint8_t>;

/// The error for a file that is not accepted. @param found  what the file is instead
tl::unexpected<std::string> Refusal(const std::string& found) {
  return tl::unexpected(fmt::format("found {}, {}", found, kAccepted));
}

/// Number in the four bytes from index `at` on, the most significant first.
std::uint32_t BigEndian(const Bytes& bytes, std::size_t at) {
  return (static_cast<std::uint32_t>(bytes[at]) << 24u) | (static_cast<std::uint32_t>(bytes[at + 1]) << 16u) |
         (static_cast<std::uint32_t>(bytes[at + 2]) << 8u) | bytes[at + 3];
}

/// Keeps only header, palette, data and end of a PNG. If libpng got a gamma or a colour profile, it would
/// convert the samples, which are densities and not brightness.
tl::expected<Bytes, std::string> SamplesOnly(const Bytes& png) {
  constexpr std::array<std::uint8_t, 8> kSignature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  // bytes around a chunk's data (length, type, checksum), and of the first chunk, the header
  constexpr std::size_t kAroundChunk = 12, kHeaderChunk = 13 + kAroundChunk;
  if (png.size() < kSignature.size() || !std::equal(kSignature.begin(), kSignature.end(), png.begin()))
    return Refusal("no PNG");
  // a chunk's type: the four letters after its length
  const auto type_at = [&](std::size_t at) {
    return std::string_view(reinterpret_cast<const char*>(png.data()) + at + 4, 4);
  };
  Bytes kept(png.begin(), png.begin() + kSignature.size());
  for (std::size_t at = kSignature.size(); png.size() - at >= kAroundChunk;) {
    const std::size_t length = BigEndian(png, at);
    if (length > png.size() - at - kAroundChunk) break;
    const std::string_view type = type_at(at);
    if (at == kSignature.size() && (type != "IHDR" || length + kAroundChunk != kHeaderChunk))
      return Refusal("a PNG that does not begin with its header");
    if (type == "tRNS") return Refusal("a PNG with transparency");
    const std::size_t next = at + length + kAroundChunk;
    if (type == "IHDR" || type == "PLTE" || type == "IDAT" || type == "IEND")
      kept.insert(kept.end(), png.begin() + static_cast<std::ptrdiff_t>(at),
                  png.begin() + static_cast<std::ptrdiff_t>(next));
    if (type == "IEND") return kept;
    at = next;
  }
  return Refusal(fmt::format("a PNG cut off after {} bytes", png.size()));
}

/// Refuses a header whose size or format is not accepted.
tl::expected<void, std::string> CheckHeader(const png_image& header) {
  const bool transparent = (header.format & PNG_FORMAT_FLAG_ALPHA) != 0;
  if ((header.format & PNG_FORMAT_FLAG_COLOR) != 0) return Refusal("a PNG in colour");
  if (transparent) return Refusal("a PNG with transparency");
  if (header.width > kMaxSamples || header.height > kMaxSamples || header.height < kMinRows)
    return tl::unexpected(fmt::format("found {} × {} pixels, accepted 1 … {} in width and {} … {} in height",
                                      header.width, header.height, kMaxSamples, kMinRows, kMaxSamples));
  return {};
}

/// Decodes the samples into image.level, 0 … 1. @returns false if the data is damaged
template <typename Sample>
bool ReadSamples(png_image& header, GreyImage& image) {
  std::vector<Sample> samples(static_cast<std::size_t>(header.width) * header.height);
  if (png_image_finish_read(&header, nullptr, samples.data(), 0, nullptr) == 0) return false;
  constexpr auto kWhite = static_cast<float>(std::numeric_limits<Sample>::max());
  image.level.reserve(samples.size());
  for (const Sample sample : samples) image.level.push_back(static_cast<float>(sample) / kWhite);
  return true;
}

/// Owns the memory that libpng allocates between reading the header and reading the samples, and frees it in
/// any case.
struct PngImage {
  png_image header{};
  PngImage() { header.version = PNG_IMAGE_VERSION; }
  ~PngImage() { png_image_free(&header); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
};

/// Reads a class of densities: its upper bound and its material.
/// @param last  whether this is the last class of the list, which takes all denser bone and has no bound
simulation::DensityClass ReadClass(Reader& section, bool last, const ReadMaterial& read_material) {
  constexpr const char* kBound = "below_g_per_cm3";
  simulation::DensityClass read;
  if (!last || section.Has(kBound)) read.below_kg_per_m3 = section.Number(kBound, 0, kDensest_g_per_cm3);
  if (last && section.Has(kBound))
    section.Refuse(kBound, fmt::format("found {:.10g} in the last class, accepted none there: it takes all "
                                       "that is denser",
                                       read.below_kg_per_m3 * 1e-3));
  read.material = read_material(section, "material");
  return read;
}

/// Refuses a class whose bound is not above the bound of the previous class.
void CheckAscending(const std::vector<Reader>& sections,
                    const std::vector<simulation::DensityClass>& classes) {
  for (std::size_t i = 0; i + 1 < classes.size(); ++i) {
    const double before = i == 0 ? 0.0 : classes[i - 1].below_kg_per_m3;
    if (!(classes[i].below_kg_per_m3 > before))
      sections[i].Refuse("below_g_per_cm3", fmt::format("found {:.10g}, accepted more than {:.10g}: classes "
                                                        "ascend",
                                                        classes[i].below_kg_per_m3 * 1e-3, before * 1e-3));
  }
}

}  // namespace

tl::expected<GreyImage, std::string> ReadGreyPng(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return tl::unexpected(fmt::format("found no file {}, accepted a grey PNG", path.string()));
  if (size > kMaxImageBytes)
    return tl::unexpected(fmt::format("found {} bytes, accepted at most {}", size, kMaxImageBytes));
  std::ifstream stream(path, std::ios::binary);
  const Bytes bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (stream.bad() || !stream.is_open())
    return tl::unexpected(std::string("found a file that can not be read, accepted a grey PNG"));
  const auto png = SamplesOnly(bytes);
  if (!png) return tl::unexpected(png.error());

  PngImage reading;
  png_image& header = reading.header;
  if (png_image_begin_read_from_memory(&header, png->data(), png->size()) == 0)
    return Refusal(fmt::format("a damaged PNG ({})", header.message));
  if (const auto checked = CheckHeader(header); !checked) return tl::unexpected(checked.error());
  GreyImage image{
      .rows = static_cast<int>(header.height), .columns = static_cast<int>(header.width), .level = {}};
  // libpng's "linear" format has samples of 16 bits
  const bool is_16_bit = (header.format & PNG_FORMAT_FLAG_LINEAR) != 0;
  header.format = is_16_bit ? PNG_FORMAT_LINEAR_Y : PNG_FORMAT_GRAY;
  if (!(is_16_bit ? ReadSamples<std::uint16_t>(header, image) : ReadSamples<std::uint8_t>(header, image)))
    return Refusal(fmt::format("a damaged PNG ({})", header.message));
  return image;
}

simulation::DensityImage ReadDensityImage(Reader section, const ReadMaterial& read_material) {
  constexpr double kFarthest_mm = 10'000.0;  // largest distance of a mesh from its frame's origin
  simulation::DensityImage image;
  const std::filesystem::path file = section.File("file");
  image.row_step_m = section.Number("row_step_mm", 0.001, 100);
  // densities of black and of white
  const std::vector<double> density = section.Numbers("density_g_per_cm3", 2, 0, kDensest_g_per_cm3);
  image.axis = section.Direction("axis");
  const std::vector<double> heights_m = section.Numbers("column_heights_mm", 2, -kFarthest_mm, kFarthest_mm);
  std::vector<Reader> classes = section.Sections("classes", 1, 16);
  for (std::size_t i = 0; i < classes.size(); ++i)
    image.classes.push_back(ReadClass(classes[i], i + 1 == classes.size(), read_material));
  section.Finish();

  CheckAscending(classes, image.classes);
  image.first_column_m = heights_m[0];
  image.last_column_m = heights_m[1];
  if (!(image.last_column_m - image.first_column_m > 1e-6))
    section.Refuse("column_heights_mm",
                   fmt::format("found {:.10g} after {:.10g}, accepted the smaller height first",
                               heights_m[1] * 1e3, heights_m[0] * 1e3));
  const auto grey = ReadGreyPng(file);
  if (!grey) section.Refuse("file", fmt::format("{}: {}", file.filename().string(), grey.error()));
  image.rows = grey->rows;
  image.columns = grey->columns;
  image.density_kg_per_m3.reserve(grey->level.size());
  for (const float level : grey->level)
    image.density_kg_per_m3.push_back(static_cast<float>(density[0] + (density[1] - density[0]) * level));
  return image;
}

}  // namespace osteon::config
