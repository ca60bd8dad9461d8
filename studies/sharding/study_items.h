#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>
#include <tl/expected.hpp>

#include "studies/sharding/shard.h"

namespace osteon::studies {

/// The items of a study, by their index. Each item is a piece of work with a result. This process computes
/// all items, or the items of a shard, or reads all results from parts. A study handles an item in the same
/// way in all three cases, so merged parts give the same result as a single run:
///
///     if (items.FromParts()) result = items.Restore(i, FromJson);
///     else if (items.Computes(i)) items.Store(i, ToJson(result = Compute(i)));
class StudyItems {
 public:
  /// @param inputs  everything that items depend on, as text: options, contents of files
  StudyItems(const Sharding& sharding, std::string_view inputs);

  /// Checks that the parts were made from the present inputs. @returns an error that names the first part;
  /// empty if they were, or if there are no parts.
  [[nodiscard]] std::string ValidateInputs() const;
  /// Checks that the parts were made from the present inputs and have the present number of items.
  /// @returns an error that names the first part; empty if both hold, or if there are no parts.
  [[nodiscard]] std::string Validate(std::size_t items) const;

  [[nodiscard]] bool FromParts() const { return sharding_.parts != nullptr; }
  [[nodiscard]] bool IsShard() const { return sharding_.shard.has_value(); }
  [[nodiscard]] bool Computes(std::size_t item) const {
    return !FromParts() && (!sharding_.shard || sharding_.shard->Has(item));
  }
  /// Returns an item's result from the parts, read from its JSON by `from`.
  /// @throws std::invalid_argument that names the part, the item and the error
  template <class From>
  auto Restore(std::size_t item, const From& from) const {
    const nlohmann::json& json = At(item);
    try {
      return from(json);
    } catch (const nlohmann::json::exception& wrong) {
      throw std::invalid_argument(WrongItem(item, wrong.what()));
    } catch (const std::invalid_argument& wrong) {
      throw std::invalid_argument(WrongItem(item, wrong.what()));
    }
  }
  /// Stores the result of an item for WritePart if the item belongs to the shard; otherwise does nothing. May
  /// be called from several threads.
  void Store(std::size_t item, nlohmann::json result);

  /// Writes the part file, and prints its name. @param items  number of items of the whole study
  /// @returns an error that names the file.
  [[nodiscard]] tl::expected<void, std::string> WritePart(const std::filesystem::path& file,
                                                          std::size_t items);

 private:
  // Returns the item's result from the parts. @throws std::invalid_argument if the parts have no such item
  [[nodiscard]] const nlohmann::json& At(std::size_t item) const;
  // Returns an error text that names the item and its part.
  [[nodiscard]] std::string WrongItem(std::size_t item, const char* wrong) const;

  Sharding sharding_;
  std::string checksum_;
  std::mutex mutex_;  ///< guards stored_
  std::map<std::size_t, nlohmann::json> stored_;
};

/// Checks the options of a sharded run; `json` is the part file, named by --json.
/// @returns an error; empty if the options are right
[[nodiscard]] std::string ValidateSharding(const Sharding& sharding, const std::filesystem::path& json);

}  // namespace osteon::studies
