#include <cmath>
#include <set>

#include "config/reading/strict/units.h"
#include "tests/fuzz/targets/config_claims.h"

// Fuzz target: the strict YAML reader. The input is the text. Each kind of query is tried for each key in the
// text.

namespace osteon::fuzz {
namespace {

// Largest number of keys that are tried for one input.
constexpr std::size_t kMaxKeys = 16;
constexpr int kMaxDepth = 3, kMaxQuestions = 200;
constexpr double kMin = -1e3, kMax = 1e3;  // accepted range of a number, in the unit of its key
const std::string kName = "fuzz.yaml";

// The words that stand before a colon.
std::set<std::string> Keys(std::string_view text) {
  const auto of_key = [](char c) { return c == '_' || std::isalnum(static_cast<unsigned char>(c)) != 0; };
  std::set<std::string> keys;
  for (std::size_t end = text.find(':'); end != std::string_view::npos && keys.size() < kMaxKeys;
       end = text.find(':', end + 1)) {
    std::size_t begin = end;
    while (begin > 0 && of_key(text[begin - 1])) --begin;
    if (begin < end) keys.emplace(text.substr(begin, end - begin));
  }
  return keys;
}

// Asks a reader for each key as a number, a word, a section and so on. Claims that each answer is in its
// range.
class Questions {
  // The reader's answer to the question; nothing if the reader refuses it.
  template <typename Question>
  auto Try(const Question& question) {
    return Loaded(question, kName, text_);
  }

 public:
  explicit Questions(std::string_view text) : text_(text), keys_(Keys(text)) {}

  void Ask(const config::Reader& reader, int depth) {
    for (const std::string& key : keys_) {
      if (++asked_ > kMaxQuestions) return;
      AskNumbers(reader, key);
      AskWords(reader, key);
      if (depth < kMaxDepth) AskSections(reader, key, depth);
    }
    Try([&] { return reader.Finish(), true; });
  }

 private:
  void AskNumbers(config::Reader reader, const std::string& key) {
    const std::optional<double> unit = config::UnitOf(key);
    if (!unit) return;
    const auto within = [&](double value) {
      return value >= kMin * *unit * (1 + 1e-12) && value <= kMax * *unit * (1 + 1e-12);
    };
    if (const auto number = Try([&] { return reader.Number(key, kMin, kMax); }))
      Claim(within(*number), "a number is in its range");
    if (const auto list = Try([&] { return reader.Numbers(key, 2, kMin, kMax); }))
      Claim(list->size() == 2 && within((*list)[0]) && within((*list)[1]), "so are the numbers of a list");
    if (const auto way = Try([&] { return reader.Direction(key); }))
      Claim(std::abs(way->norm() - 1.0) <= 1e-12, "a direction has length 1");
    if (const auto whole = Try([&] { return reader.WholeNumber(key, -5, 255); }))
      Claim(*whole >= -5 && *whole <= 255, "a whole number is in its range");
  }

  void AskWords(config::Reader reader, const std::string& key) {
    const bool there = reader.Has(key);
    if (const auto word = Try([&] { return reader.Text(key); }))
      Claim(there != word->empty(), "a text is not empty");
    if (const auto place = Try([&] { return reader.Choice(key, {"fri", "burr", "cup"}); }))
      Claim(*place < 3, "a choice is one of those accepted");
    if (const auto places = Try([&] { return reader.Words(key, {"x", "y", "rx"}); }))
      Claim(std::set<std::size_t>(places->begin(), places->end()).size() == places->size() &&
                places->size() <= 3,
            "none is chosen twice");
    Try([&] { return reader.Bool(key); });
  }

  void AskSections(config::Reader reader, const std::string& key, int depth) {
    if (!reader.Has(key)) return;
    if (const auto section = Try([&] { return reader.Section(key); })) Ask(*section, depth + 1);
    if (const auto list = Try([&] { return reader.Sections(key, 0, 4); })) {
      Claim(list->size() <= 4, "a list has as many mappings as are accepted");
      for (const config::Reader& each : *list) Ask(each, depth + 1);
    }
    Try([&] { return reader.OneSection({key.c_str(), "other"}); });
  }

  std::string_view text_;
  std::set<std::string> keys_;
  int asked_{0};
};

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace osteon;
  const std::string text = fuzz::Text({data, size});
  const auto reader =
      fuzz::Loaded([&] { return config::Reader::Parse(text, fuzz::kName); }, fuzz::kName, text);
  if (reader) fuzz::Questions(text).Ask(*reader, 0);
  return 0;
}
