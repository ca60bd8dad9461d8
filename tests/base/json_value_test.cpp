#include "base/json_value.h"

#include <gtest/gtest.h>

namespace osteon::base {
namespace {

using nlohmann::json;

TEST(JsonValue, GivesTheValueOfItsType) {
  const json object{{"text", "a"}, {"number", 2}, {"flag", true}, {"list", {1, 2}}};
  EXPECT_EQ(TextAt(object, "text"), "a");
  EXPECT_EQ(NumberAt(object, "number"), 2.0);
  EXPECT_TRUE(FlagAt(object, "flag"));
  EXPECT_EQ(ValueAt(object, "list").size(), 2u);
}

TEST(JsonValue, GivesTheFallbackForAnotherTypeOrAMissingKey) {
  for (const json& value : {json(), json(3), json("text"), json::array({1}), json{{"key", {}}}}) {
    EXPECT_EQ(TextAt(value, "key", "none"), "none") << value;
    EXPECT_EQ(NumberAt(value, "key", 7.0), 7.0) << value;
    EXPECT_TRUE(FlagAt(value, "key", true)) << value;
    EXPECT_TRUE(ValueAt(value, "key").empty()) << value;
  }
  EXPECT_EQ(TextAt(json{{"key", 1}}, "key"), "");
  EXPECT_EQ(NumberAt(json{{"key", true}}, "key"), 0.0);
  EXPECT_FALSE(FlagAt(json{{"key", 1}}, "key"));
}

}  // namespace
}  // namespace osteon::base
