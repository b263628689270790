#include "tactus/scene/json.h"

#include <gtest/gtest.h>

#include <limits>

namespace tactus {
namespace {

TEST(JsonString, EscapesWhatWouldBreakIt) {
  EXPECT_EQ(jsonString("plain"), R"("plain")");
  EXPECT_EQ(jsonString("\"\\\n\t\x1f"), R"("\"\\\u000a\u0009\u001f")");
  EXPECT_EQ(jsonString(std::string("a\0b", 3)), R"("a\u0000b")");
  EXPECT_EQ(jsonString("\xc3\xa9"), "\"\xc3\xa9\"");
  EXPECT_EQ(jsonString("\xc3"), R"("\ufffd")");
  EXPECT_EQ(jsonString("\xff\xfe"), R"("\ufffd\ufffd")");
}

TEST(JsonWriter, NestsObjectsAndArrays) {
  JsonWriter json;
  json.beginObject();
  json.key("a").value(1);
  json.key("b").beginArray();
  json.value("x");
  json.value(true);
  json.null();
  json.beginObject();
  json.endObject();
  json.endArray();
  json.key("c").beginArray();
  json.endArray();
  json.endObject();
  EXPECT_EQ(json.text(),
            "{\n  \"a\": 1,\n  \"b\": [\n    \"x\",\n    true,\n    null,\n    {}\n  ],\n"
            "  \"c\": []\n}\n");
}

TEST(JsonWriter, NumbersAreShortestAndFinite) {
  const auto written = [](double number) {
    JsonWriter json;
    json.value(number);
    return json.text();
  };
  EXPECT_EQ(written(0.1), "0.1\n");
  EXPECT_EQ(written(7000.0), "7000\n");
  EXPECT_EQ(written(-0.0), "-0\n");
  EXPECT_EQ(written(std::numeric_limits<double>::infinity()), "null\n");
  EXPECT_EQ(written(std::numeric_limits<double>::quiet_NaN()), "null\n");
}

}  // namespace
}  // namespace tactus
