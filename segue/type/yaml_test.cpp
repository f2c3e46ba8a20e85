// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/type/yaml.hpp>
#include <support/random_values.hpp>
#include <support/shared_data.hpp>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

namespace segue::type {
namespace {

using ::testing::HasSubstr;

Value parsed(std::string_view text) {
  auto value = parse_yaml(text, "a.yaml");
  if (value) return *std::move(value);
  ADD_FAILURE() << to_string(value.error());
  return {};
}

Error refusal(std::string_view text) {
  const auto value = parse_yaml(text, "a.yaml");
  if (!value) return value.error();
  ADD_FAILURE() << "accepted as " << to_yaml(*value);
  return {};
}

void expect_refusal(std::string_view text, std::string_view message, int line, int column) {
  const Error error = refusal(text);
  EXPECT_EQ(error.code, ErrorCode::ParseError);
  EXPECT_THAT(error.message, HasSubstr(std::string(message)));
  EXPECT_EQ(error.where, (SourceLocation{"a.yaml", line, column})) << to_string(error);
}

std::string nested(std::size_t levels) {
  return std::string(levels, '[') + std::string(levels, ']');
}

TEST(Yaml, EmptyTextIsNull) {
  EXPECT_TRUE(parsed(std::string_view()).is_null());
  EXPECT_TRUE(parsed("").is_null());
  EXPECT_TRUE(parsed("# only a comment\n").is_null());
  EXPECT_TRUE(parsed("---\n").is_null());
}

TEST(Yaml, PlainScalarsFollowTheCoreSchema) {
  const Value value = parsed(
      "[~, null, Null, true, FALSE, 12, -7, +3, 0x1F, 0o17, 010, 1.5, .5, 5., -1e3, .inf, -.Inf, .nan]");
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(value, Value::list({{},
                                {},
                                {},
                                true,
                                false,
                                12,
                                -7,
                                3,
                                31,
                                15,
                                10,
                                1.5,
                                0.5,
                                5.0,
                                -1000.0,
                                kInfinity,
                                -kInfinity,
                                std::nan("")}));
  EXPECT_EQ(value.as_list()[11].kind(), Value::Kind::Float);
  EXPECT_EQ(value.as_list()[5].kind(), Value::Kind::Int);
}

TEST(Yaml, EverythingElseIsText) {
  for (const char* text :
       {"yes", "no", "on",  "2026-11-21", "12:30", "1_000", "0b1",  "1e",    "1.2.3", "--1",
        "+",   ".",  "nan", "inf",        "0x",    "0xg",   "0x-1", "1e999", "tRUE",  "base::Pose"}) {
    EXPECT_EQ(parsed(text), Value(text));
  }
}

TEST(Yaml, QuotedScalarsAreText) {
  EXPECT_EQ(parsed("['10', \"true\", '', 'a''b', \"\\u00e9\\0\"]"),
            Value::list({"10", "true", "", "a'b", Value(std::string("\xC3\xA9\0", 3))}));
}

TEST(Yaml, IntegersReachToTheEndsOf64Bits) {
  const Value value = parsed("[18446744073709551615, 9223372036854775808, -9223372036854775808]");
  EXPECT_EQ(value.as_list()[0].as_uint(), std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(value.as_list()[1].kind(), Value::Kind::UInt);
  EXPECT_EQ(value.as_list()[2].as_int(), std::numeric_limits<std::int64_t>::min());
  const Value beyond = parsed("18446744073709551616");
  EXPECT_EQ(beyond.kind(), Value::Kind::Float);
  EXPECT_EQ(beyond.source_text(), "18446744073709551616");
}

TEST(Yaml, SourceTextIsKeptWhereThePrintDiffers) {
  const Value value = parsed("[1.10, 0x1F, 1.5, 7, True, ~, 'x', 007]");
  std::vector<std::string> texts;
  for (const Value& item : value.as_list())
    texts.emplace_back(item.source_text());
  EXPECT_THAT(texts, ::testing::ElementsAre("1.10", "0x1F", "", "", "True", "~", "", "007"));
}

TEST(Yaml, EveryValueHasItsPlace) {
  const Value value = parsed("a: 1\nb:\n  - x\n  - {c: \xC3\xA9, d: 2}\n");
  auto place = [](const Value& v) { return std::pair(v.mark().line, v.mark().column); };
  EXPECT_EQ(place(value), std::pair(1U, 1U));
  EXPECT_EQ(place(*value.find("a")), std::pair(1U, 4U));
  EXPECT_EQ(place(*value.find("b")), std::pair(3U, 3U));
  EXPECT_EQ(place(value.find("b")->as_list()[1]), std::pair(4U, 5U));
  EXPECT_EQ(place(*value.find("b")->as_list()[1].find("d")), std::pair(4U, 15U));  // characters, not bytes
}

TEST(Yaml, MapsKeepTheirOrderAndKeysTheirSpelling) {
  const Value value = parsed("z: 1\n1.10: 2\ntrue: 3\n'<<': 4\n");
  std::vector<std::string> keys;
  for (const auto& [key, entry] : value.as_map())
    keys.push_back(key);
  EXPECT_THAT(keys, ::testing::ElementsAre("z", "1.10", "true", "<<"));
}

TEST(Yaml, AliasesRepeatTheirAnchor) {
  EXPECT_EQ(parsed("a: &x {p: [1, 2]}\nb: *x\nc: &x 5\nd: *x\n&k e: *x\n"),
            Value::map({{"a", Value::map({{"p", Value::list({1, 2})}})},
                        {"b", Value::map({{"p", Value::list({1, 2})}})},
                        {"c", 5},
                        {"d", 5},
                        {"e", 5}}));
}

TEST(Yaml, TagsOfTheCoreSchemaDecideOthersAreIgnored) {
  EXPECT_EQ(parsed("[!!str 10, !!float 10, !!int 0x10, ! 10, !!seq [], !!map {}, !!null ~]"),
            Value::list({"10", 10.0, 16, "10", Value(Value::List{}), Value(ValueMap{}), {}}));
  EXPECT_EQ(parsed("!!float 10").kind(), Value::Kind::Float);
  expect_refusal("a: !!int x", "'x' cannot be read as its tag says (!!int)", 1, 4);
  expect_refusal("a: !!binary x", "'x' cannot be read as its tag says (!!binary)", 1, 4);
  EXPECT_EQ(parsed("[!!python/unicode 'x', !ruby/symbol y, !z 7, !!set {a: ~}]"),
            Value::list({"x", "y", 7, Value::map({{"a", {}}})}));
}

TEST(Yaml, DuplicateKeysAreRefused) {
  expect_refusal("a: 1\nb: 2\na: 3\n", "the key 'a' occurs twice", 3, 1);
  std::string many;
  for (int i = 0; i < 1000; ++i)
    many += "k" + std::to_string(i) + ": 0\n";
  EXPECT_EQ(parsed(many).as_map().size(), 1000U);
  expect_refusal(many + "k500: 0\n", "the key 'k500' occurs twice", 1001, 1);
}

TEST(Yaml, OnlyScalarsAreKeys) {
  expect_refusal("? [a, b]\n: 1\n", "a key must be a scalar, not a list", 1, 3);
  expect_refusal("{{a: b}: c}", "a key must be a scalar, not a map", 1, 2);
  expect_refusal("a: &x y\n*x : 1\n", "the alias '*x' cannot be a key", 2, 1);
}

TEST(Yaml, MergeKeysAreRefused) {
  expect_refusal("a: &a {x: 1}\nb:\n  <<: *a\n", "merge keys ('<<') are not supported", 3, 3);
}

TEST(Yaml, OneDocumentOnly) {
  EXPECT_EQ(parsed("---\na: 1\n...\n"), Value::map({{"a", 1}}));
  expect_refusal("a: 1\n---\nb: 2\n", "a second document begins here", 2, 1);
}

TEST(Yaml, NestingEndsAt200Levels) {
  EXPECT_TRUE(parsed(nested(200)).is_list());
  expect_refusal(nested(201), "deeper than 200 levels", 1, 201);
  // An alias must not smuggle depth in.
  const std::string half = nested(150);
  expect_refusal("a: &a " + half + "\nb: " + std::string(60, '[') + "*a" + std::string(60, ']'),
                 "deeper than 200", 2, 64);
}

TEST(Yaml, AliasExpansionHasABudget) {
  std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string alias = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + alias;
    for (int k = 0; k < 9; ++k)
      bomb += ", " + alias;
    bomb += "]\n";
  }
  EXPECT_THAT(refusal(bomb).message, HasSubstr("more than a million values"));
  std::string bytes = "a: &a " + std::string(100'000, 'x') + "\nb: [*a";
  for (int i = 0; i < 1000; ++i)
    bytes += ", *a";
  EXPECT_THAT(refusal(bytes + "]\n").message, HasSubstr("more than a million values"));
}

TEST(Yaml, AliasesNeedAnAnchorBeforeThem) {
  expect_refusal("a: *x", "no value before this place has the anchor '&x'", 1, 4);
  expect_refusal("&x [*x]", "no value before this place has the anchor '&x'", 1, 5);
}

TEST(Yaml, SyntaxErrorsNameTheirPlace) {
  expect_refusal("a: [1, 2\nb: 3\n", "flow sequence", 2, 2);
  expect_refusal("a:\n\tb: 1\n", "indent with spaces", 2, 1);
  expect_refusal("a: 1\nb: \xFF\n", "UTF-8", 2, 4);
  expect_refusal(std::string_view("a: \0", 4), "control characters", 1, 4);
}

TEST(Yaml, LoadNamesTheFile) {
  const auto value = load_yaml("/no/such/file.yaml");
  ASSERT_FALSE(value);
  EXPECT_THAT(to_string(value.error()), HasSubstr("/no/such/file.yaml"));
}

TEST(YamlWriter, WritesBlocksWithLeavesOnALine) {
  const Value value = Value::map(
      {{"network", "goal_navigation"},
       {"tasks", Value::map({{"velodyne", Value::map({{"range", Value::map({{"max", 30.0}, {"min", 0.1}})},
                                                      {"rates", Value::list({1, 2, 3})},
                                                      {"none", Value()},
                                                      {"empty", Value(Value::List{})}})}})}});
  EXPECT_EQ(to_yaml(value),
            "network: goal_navigation\n"
            "tasks:\n"
            "  velodyne:\n"
            "    range: {max: 30.0, min: 0.1}\n"
            "    rates: [1, 2, 3]\n"
            "    none: null\n"
            "    empty: []\n");
}

TEST(YamlWriter, LongLeavesTakeALineEach) {
  const Value value(Value::List(40, Value(100)));
  EXPECT_THAT(to_yaml(value), ::testing::StartsWith("- 100\n- 100\n"));
}

TEST(YamlWriter, QuotesOnlyWhatWouldReadBackAsSomethingElse) {
  EXPECT_EQ(to_yaml(Value::list({"far", "10", "true", "", "yes", "a: b", "base::Pose", 1.0, 1e20})),
            "[far, '10', 'true', '', 'yes', 'a: b', 'base::Pose', 1.0, 1.0e+20]\n");
  EXPECT_EQ(to_yaml(Value::map({{"1", 1}, {"true", 2}, {"<<", 3}})), "{1: 1, 'true': 2, '<<': 3}\n");
}

TEST(YamlWriter, KeepsHowANumberWasWritten) {
  EXPECT_EQ(to_yaml(parsed("[1.10, 0x1F]")), "[1.10, 0x1F]\n");
  Value forged(3);
  forged.set_source_text("4");
  EXPECT_EQ(to_yaml(forged).substr(0, 1), "3");
}

TEST(YamlWriter, ReplacesWhatIsNotUtf8) {
  EXPECT_EQ(parsed(to_yaml(Value("a\xFFz"))), Value("a\xEF\xBF\xBDz"));
}

RC_GTEST_PROP(YamlWriter, WhatIsWrittenReadsBack, ()) {
  const Value value = *random_value();
  const auto again = parse_yaml(to_yaml(value));
  RC_ASSERT(again.has_value());
  RC_ASSERT(*again == value);
}

RC_GTEST_PROP(YamlWriter, WritingTwiceChangesNothing, ()) {
  const std::string once = to_yaml(*random_value());
  RC_ASSERT(to_yaml(parsed(once)) == once);
}

// Rock's property files hold several documents and are read by the model importer; all others are one.
TEST(YamlSharedData, FilesAreReadAndWrittenBackEqual) {
  if (const auto missing = missing_shared_data(); !missing.empty()) GTEST_SKIP() << missing;
  int read = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(shared_data())) {
    const auto extension = entry.path().extension();
    if (extension != ".yml" && extension != ".yaml" && extension != ".cnd") continue;
    const auto value = load_yaml(entry.path());
    ASSERT_TRUE(value) << to_string(value.error());
    EXPECT_EQ(parsed(to_yaml(*value)), *value) << entry.path();
    ++read;
  }
  EXPECT_GT(read, 20);
}

}  // namespace
}  // namespace segue::type
