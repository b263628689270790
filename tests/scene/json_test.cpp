#include "tactus/scene/json.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

namespace tactus {
namespace {

TEST(JsonText, KeepsTheOrderOfMembersAndIndents) {
  const Json json = {{"b", 1}, {"a", {"x", true, nullptr, Json::object()}}, {"c", Json::array()}};
  EXPECT_EQ(jsonText(json),
            "{\n  \"b\": 1,\n  \"a\": [\n    \"x\",\n    true,\n    null,\n    {}\n  ],\n"
            "  \"c\": []\n}\n");
}

TEST(JsonText, EscapesWhatWouldBreakAText) {
  EXPECT_EQ(jsonText("\"\\\n\x1f"), "\"\\\"\\\\\\n\\u001f\"\n");
  EXPECT_EQ(jsonText(std::string("a\0b", 3)), "\"a\\u0000b\"\n");
  EXPECT_EQ(jsonText("\xc3\xa9"), "\"\xc3\xa9\"\n");
  EXPECT_EQ(jsonText("\xff\xfe"), "\"\xef\xbf\xbd\xef\xbf\xbd\"\n") << "no UTF-8";
}

TEST(JsonText, NumbersKeepEveryBitOrAreNull) {
  for (const double number : {0.1 + 0.2, -0.0, 1.0 / 3.0, std::numeric_limits<double>::denorm_min(),
                              std::numeric_limits<double>::max()}) {
    const double read = Json::parse(jsonText(number)).get<double>();
    EXPECT_EQ(std::memcmp(&read, &number, sizeof(double)), 0) << jsonText(number);
  }
  EXPECT_EQ(jsonText(0.1), "0.1\n");
  EXPECT_EQ(jsonText(std::numeric_limits<double>::infinity()), "null\n");
  EXPECT_EQ(jsonText(std::numeric_limits<double>::quiet_NaN()), "null\n");
}

}  // namespace
}  // namespace tactus
