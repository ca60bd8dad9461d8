#include "studies/sharding/shard.h"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

namespace osteon::studies {
namespace {

// Returns the number if the whole text is a decimal number; otherwise nothing.
std::optional<int> NumberFrom(std::string_view text) {
  int number = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || rest != text.data() + text.size()) return {};
  return number;
}

}  // namespace

tl::expected<Shard, std::string> ParseShard(const std::string& text) {
  const std::string_view whole = text;
  const std::size_t slash = whole.find('/');
  if (slash != std::string_view::npos) {
    const auto index = NumberFrom(whole.substr(0, slash)), of = NumberFrom(whole.substr(slash + 1));
    if (index && of && *of >= 1 && *of <= kMaxShards && *index >= 1 && *index <= *of)
      return Shard{.index = *index, .of = *of};
  }
  return tl::unexpected(
      fmt::format("found {}, accepted I/N with 1 ≤ I ≤ N ≤ {}, e.g. 2/4", text, kMaxShards));
}

std::vector<std::string> WithoutOptions(const std::vector<std::string>& words,
                                        const std::vector<std::string>& options) {
  std::vector<std::string> kept;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string name = words[i].substr(0, words[i].find('='));
    if (std::ranges::find(options, name) == options.end())
      kept.push_back(words[i]);
    else if (name == words[i])
      ++i;  // skip the option's value, which is the next word
  }
  return kept;
}

void AddName(std::string& list, const std::string& name) {
  if (list.empty())
    list = name;
  else if (("; " + list + "; ").find("; " + name + "; ") == std::string::npos)
    list += "; " + name;
}

}  // namespace osteon::studies
