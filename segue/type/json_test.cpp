// SPDX-License-Identifier: Apache-2.0
#include <segue/type/json.hpp>
#include <support/random_values.hpp>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

namespace segue::type {
namespace {

using ::testing::HasSubstr;

Value parsed(std::string_view text) {
  auto value = parse_json(text, "a.json");
  if (value) return *std::move(value);
  ADD_FAILURE() << to_string(value.error());
  return {};
}

void expect_refusal(std::string_view text, std::string_view message, int line, int column) {
  const auto value = parse_json(text, "a.json");
  ASSERT_FALSE(value) << to_json(*value);
  EXPECT_EQ(value.error().code, ErrorCode::ParseError);
  EXPECT_THAT(value.error().message, HasSubstr(std::string(message)));
  EXPECT_EQ(value.error().where, (SourceLocation{"a.json", line, column})) << to_string(value.error());
}

std::string nested(std::size_t levels) {
  return std::string(levels, '[') + std::string(levels, ']');
}

// The value as to_json documents it: parts that JSON cannot carry are replaced.
Value as_json_keeps_it(const Value& value) {
  if (value.is_list()) {
    Value::List list;
    for (const Value& item : value.as_list())
      list.push_back(as_json_keeps_it(item));
    return list;
  }
  if (value.is_map()) {
    ValueMap map;
    for (const auto& [key, entry] : value.as_map())
      map.set(key, as_json_keeps_it(entry));
    return map;
  }
  return value.kind() == Value::Kind::Float && !std::isfinite(value.as_double()) ? Value() : value;
}

TEST(Json, ReadsEveryKindOfValue) {
  EXPECT_EQ(parsed(R"( {"a": [null, true, false, -3, 1.5, 2e3, "x\n\u00e9\ud83e\udd16"], "b": {}} )"),
            Value::map({{"a", Value::list({{}, true, false, -3, 1.5, 2000.0, "x\n\xC3\xA9\xF0\x9F\xA4\x96"})},
                        {"b", Value(ValueMap{})}}));
}

TEST(Json, IntegersReachToTheEndsOf64BitsAndBecomeFloatsBeyond) {
  const Value value = parsed("[18446744073709551615, -9223372036854775808, 18446744073709551616, 1.0]");
  EXPECT_EQ(value.as_list()[0].as_uint(), std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(value.as_list()[1].as_int(), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(value.as_list()[2].kind(), Value::Kind::Float);
  EXPECT_EQ(value.as_list()[3].kind(), Value::Kind::Float);
}

TEST(Json, EveryValueHasItsPlace) {
  const Value value = parsed("{\"\xC3\xA9\": [10,\n true, \"q\\\\\\\"\", null],\n\"b\": -1.5e3}");
  auto place = [](const Value& v) { return std::pair(v.mark().line, v.mark().column); };
  EXPECT_EQ(place(value), std::pair(1U, 1U));
  const auto& list = value.find("\xC3\xA9")->as_list();
  EXPECT_EQ(place(list[0]), std::pair(1U, 8U));
  EXPECT_EQ(place(list[1]), std::pair(2U, 2U));
  EXPECT_EQ(place(list[2]), std::pair(2U, 8U));
  EXPECT_EQ(place(list[3]), std::pair(2U, 17U));
  EXPECT_EQ(place(*value.find("b")), std::pair(3U, 6U));
  EXPECT_EQ(place(parsed("  7")), std::pair(1U, 3U));
}

TEST(Json, DuplicateKeysAreRefused) {
  expect_refusal("{\"a\": 1,\n \"a\": 2}", "the key 'a' occurs twice", 2, 2);
}

TEST(Json, NestingEndsAt200Levels) {
  EXPECT_TRUE(parsed(nested(200)).is_list());
  expect_refusal(nested(201), "deeper than 200 levels", 1, 201);
}

TEST(Json, SyntaxErrorsNameTheirPlace) {
  expect_refusal("", "found nothing", 1, 1);
  expect_refusal("{\"a\":\n 1,}", "object key", 2, 4);
  expect_refusal("[1 2]", "unexpected number literal", 1, 5);
  expect_refusal("1e999", "number overflow", 1, 5);
  expect_refusal("\"\xFF\"", "ill-formed UTF-8", 1, 2);
  expect_refusal("[1] x", "end of input", 1, 5);
}

TEST(JsonWriter, IndentsOrWritesOneLine) {
  const Value value = Value::map({{"a", Value::list({1, 2.0, "x"})}, {"e", Value(Value::List{})}});
  EXPECT_EQ(to_json(value), "{\n  \"a\": [\n    1,\n    2.0,\n    \"x\"\n  ],\n  \"e\": []\n}");
  EXPECT_EQ(to_json(value, -1), R"({"a":[1,2.0,"x"],"e":[]})");
}

TEST(JsonWriter, WritesNullForWhatJsonLacks) {
  EXPECT_EQ(to_json(Value::list({std::nan(""), std::numeric_limits<double>::infinity()}), -1), "[null,null]");
}

TEST(JsonWriter, EscapesAndReplaces) {
  EXPECT_EQ(to_json(Value(std::string("\"\\\n\x01\0", 5))), R"("\"\\\n\u0001\u0000")");
  EXPECT_EQ(to_json(Value("\xED\xA0\x80|\xC3|\xC0\xAF")),
            "\"\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD|\xEF\xBF\xBD|\xEF\xBF\xBD\xEF\xBF\xBD\"");
}

RC_GTEST_PROP(JsonWriter, WhatIsWrittenReadsBack, ()) {
  const Value value = *random_value();
  const auto again = parse_json(to_json(value, *rc::gen::inRange(-1, 3)));
  RC_ASSERT(again.has_value());
  RC_ASSERT(*again == as_json_keeps_it(value));
}

}  // namespace
}  // namespace segue::type
