#include "studies/tune/tune_cache.h"

#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "base/fnv1a.h"
#include "base/json_value.h"
#include "base/write_text.h"

namespace osteon::studies {
namespace {

constexpr const char* kSchema = "osteon.tune_cache/1";

}  // namespace

TuneCache::TuneCache(std::filesystem::path file)
    : file_(std::move(file)), loaded_(nlohmann::json::object()), kept_(nlohmann::json::object()) {
  std::ifstream stream(file_);
  const nlohmann::json read = nlohmann::json::parse(stream, nullptr, false);
  if (base::TextAt(read, "schema") != kSchema) return;
  if (const nlohmann::json& values = base::ValueAt(read, "values"); values.is_object()) loaded_ = values;
}

std::string TuneCache::Key(const std::string& from) {
  base::Fnv1a hash;
  hash.Add(from);
  return fmt::format("{:016x}", hash.hash());
}

std::optional<std::vector<double>> TuneCache::Find(const std::string& from) {
  const std::scoped_lock lock(mutex_);
  const auto at = loaded_.find(Key(from));
  if (at == loaded_.end() || !at->is_array()) return {};
  std::vector<double> values;
  for (const nlohmann::json& value : *at) {
    if (!value.is_number() && !value.is_null()) return {};
    // infinity was saved as null, because JSON has no infinity
    values.push_back(value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>());
  }
  kept_[Key(from)] = *at;
  ++found_;
  return values;
}

void TuneCache::Store(const std::string& from, const std::vector<double>& values) {
  const std::scoped_lock lock(mutex_);
  nlohmann::json list = nlohmann::json::array();
  for (const double value : values)
    list.push_back(std::isfinite(value) ? nlohmann::json(value) : nlohmann::json());
  kept_[Key(from)] = list;
  ++computed_;
}

tl::expected<void, std::string> TuneCache::Save() const {
  const std::scoped_lock lock(mutex_);
  return base::WriteText(file_, nlohmann::json{{"schema", kSchema}, {"values", kept_}}.dump(1) + "\n");
}

}  // namespace osteon::studies
