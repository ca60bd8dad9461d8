#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// Runs each libFuzzer target in a normal build without clang: on its corpus, and on random changes of the
// corpus with a fixed seed. OSTEON_FUZZ_RUNS sets the number of changed inputs per target.

// The entry functions of the targets. This folder's CMakeLists.txt gives each of them its own name.
extern "C" {
int OsteonFuzz_fri_decode(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_fri_session(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_rsi(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_engine_message(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_can(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_plc(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_yaml(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_config_file(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_tool_file(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_cell(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_plan_file(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_study_file(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_density_image(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_mesh(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_motion(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_packing(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_packing_text(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_carved(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_recording(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_recording_message(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_session_file(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_console_message(const std::uint8_t* data, std::size_t size);
int OsteonFuzz_foxglove_request(const std::uint8_t* data, std::size_t size);
}

namespace osteon::fuzz {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr unsigned kSeed = 20240915;

struct Target {
  const char* name;
  int (*run)(const std::uint8_t*, std::size_t);
  int runs{5'000};  ///< number of changed inputs
};
void PrintTo(const Target& target, std::ostream* out) { *out << target.name; }

// The target's seeds: all files of the folders that seeds.txt names for it.
std::vector<Bytes> Corpus(const std::string& target) {
  const std::filesystem::path root(OSTEON_SOURCE_DIR);
  std::vector<std::filesystem::path> files;
  std::ifstream seeds(root / "tests/fuzz/seeds.txt");
  for (std::string line; std::getline(seeds, line);) {
    std::istringstream words(line);
    std::string word;
    if (!(words >> word) || word != target) continue;
    while (words >> word)
      for (const auto& entry : std::filesystem::directory_iterator(root / word))
        if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<Bytes> corpus;
  for (const auto& file : files) {
    std::ifstream in(file, std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  return corpus;
}

// Changes inputs as libFuzzer does, but without feedback about the coverage.
class Mutator {
 public:
  std::size_t Below(std::size_t n) { return random_() % n; }

  Bytes Change(const std::vector<Bytes>& corpus) {
    Bytes bytes = corpus[Below(corpus.size())];
    for (std::size_t changes = 1 + Below(4); changes > 0 && !bytes.empty(); --changes) {
      const auto here = bytes.begin() + static_cast<std::ptrdiff_t>(Below(bytes.size()));
      const auto behind = here + static_cast<std::ptrdiff_t>(Below(std::min<std::size_t>(
                                     33, static_cast<std::size_t>(bytes.end() - here) + 1)));
      switch (Below(8)) {
        case 0:
          *here = static_cast<std::uint8_t>(Below(256));
          break;
        case 1:
          *here ^= static_cast<std::uint8_t>(1u << Below(8));
          break;
        case 2: {
          constexpr std::uint8_t kNotable[]{0, 1, 0x7f, 0x80, 0xff, '0', '9', '-', '"', '<', ':', '\n'};
          *here = kNotable[Below(std::size(kNotable))];
          break;
        }
        case 3:
          bytes.insert(here, static_cast<std::uint8_t>(Below(256)));
          break;
        case 4:
          bytes.erase(here, behind);
          break;
        case 5: {
          const Bytes piece(here, behind);
          bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(Below(bytes.size() + 1)), piece.begin(),
                       piece.end());
          break;
        }
        case 6: {  // appends the end of another input
          const Bytes& other = corpus[Below(corpus.size())];
          bytes.erase(here, bytes.end());
          const std::size_t from = Below(other.size() + 1);
          bytes.insert(bytes.end(), other.begin() + static_cast<std::ptrdiff_t>(from), other.end());
          break;
        }
        default:
          if (Below(4) == 0) bytes.erase(here, bytes.end());
      }
    }
    return bytes;
  }

 private:
  std::mt19937 random_{kSeed};
};

class FuzzTarget : public testing::TestWithParam<Target> {
 protected:
  // Runs the target on an input. If a claim does not hold, the test fails and prints the input in
  // hexadecimal. @returns whether all claims hold
  static bool HoldsClaims(const Bytes& bytes) {
    const Bytes exact(
        bytes);  // a copy of exactly this size, so that a sanitizer detects a read behind its end
    try {
      GetParam().run(exact.data(), exact.size());
      return true;
    } catch (const std::exception& claim) {
      std::string hex;
      for (const std::uint8_t byte : bytes)
        hex += "0123456789abcdef"[byte >> 4], hex += "0123456789abcdef"[byte & 15];
      ADD_FAILURE() << "not so: " << claim.what() << "\n" << hex;
      return false;
    }
  }
};

TEST_P(FuzzTarget, HoldsItsClaimsOverTheCorpus) {
  const auto corpus = Corpus(GetParam().name);
  ASSERT_GE(corpus.size(), 2u);
  for (const Bytes& bytes : corpus) HoldsClaims(bytes);
  HoldsClaims({});
}

TEST_P(FuzzTarget, HoldsItsClaimsOverChangesOfTheCorpus) {
  SCOPED_TRACE(kSeed);
  const char* wanted = std::getenv("OSTEON_FUZZ_RUNS");
  const int runs = wanted == nullptr ? GetParam().runs : std::max(1, std::atoi(wanted));
  const auto corpus = Corpus(GetParam().name);
  ASSERT_FALSE(corpus.empty());
  Mutator mutator;
  for (int i = 0; i < runs; ++i) ASSERT_TRUE(HoldsClaims(mutator.Change(corpus))) << i;
}

std::string NameOf(const testing::TestParamInfo<Target>& target) { return target.param.name; }

INSTANTIATE_TEST_SUITE_P(Wire, FuzzTarget,
                         testing::Values(Target{"fri_decode", OsteonFuzz_fri_decode},
                                         Target{"fri_session", OsteonFuzz_fri_session},
                                         Target{"rsi", OsteonFuzz_rsi}, Target{"can", OsteonFuzz_can},
                                         Target{"plc", OsteonFuzz_plc},
                                         Target{"engine_message", OsteonFuzz_engine_message}),
                         NameOf);
INSTANTIATE_TEST_SUITE_P(Config, FuzzTarget,
                         testing::Values(Target{"yaml", OsteonFuzz_yaml},
                                         Target{"config_file", OsteonFuzz_config_file, 500},
                                         Target{"tool_file", OsteonFuzz_tool_file, 500},
                                         Target{"cell", OsteonFuzz_cell, 500},
                                         Target{"plan_file", OsteonFuzz_plan_file, 100},
                                         Target{"study_file", OsteonFuzz_study_file},
                                         Target{"density_image", OsteonFuzz_density_image}),
                         NameOf);
INSTANTIATE_TEST_SUITE_P(Files, FuzzTarget,
                         testing::Values(Target{"mesh", OsteonFuzz_mesh}, Target{"motion", OsteonFuzz_motion},
                                         Target{"packing", OsteonFuzz_packing},
                                         Target{"packing_text", OsteonFuzz_packing_text},
                                         Target{"carved", OsteonFuzz_carved},
                                         Target{"recording", OsteonFuzz_recording},
                                         Target{"recording_message", OsteonFuzz_recording_message},
                                         Target{"session_file", OsteonFuzz_session_file},
                                         Target{"console_message", OsteonFuzz_console_message},
                                         Target{"foxglove_request", OsteonFuzz_foxglove_request}),
                         NameOf);

}  // namespace
}  // namespace osteon::fuzz
