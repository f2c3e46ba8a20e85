// SPDX-License-Identifier: Apache-2.0
#include <segue/type/conform.hpp>
#include <segue/type/yaml.hpp>

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace segue::type {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Type numeric(NumericCategory category, std::size_t size, std::int64_t tick = 0) {
  Type type;
  type.kind = TypeKind::Numeric;
  type.category = category;
  type.size = size;
  type.nanoseconds_per_tick = tick;
  return type;
}

Type made_of(TypeKind kind, const Type& element, std::string container_kind = {}, std::size_t count = 0) {
  Type type;
  type.kind = kind;
  type.element = &element;
  type.container_kind = std::move(container_kind);
  type.count = count;
  return type;
}

/// The types that the cases share.
struct Types {
  Type boolean = numeric(NumericCategory::Bool, 1);
  Type byte = numeric(NumericCategory::Unsigned, 1);
  Type int64 = numeric(NumericCategory::Signed, 8);
  Type real = numeric(NumericCategory::Float, 8);
  Type single = numeric(NumericCategory::Float, 4);
  Type milliseconds = numeric(NumericCategory::Signed, 8, 1'000'000);
  Type seconds = numeric(NumericCategory::Float, 8, 1'000'000'000);
  Type text = made_of(TypeKind::Container, byte, "/std/string");
  Type reals = made_of(TypeKind::Container, real, "/std/vector");
  Type three = made_of(TypeKind::Array, real, {}, 3);
  Type maybe = made_of(TypeKind::Container, real, "/std/optional");
  Type alias = made_of(TypeKind::Alias, real);
  Type opaque;
  Type mode;
  Type range;
  Type ranges;

  Types() {
    opaque.kind = TypeKind::Opaque;
    mode.kind = TypeKind::Enum;
    mode.name = "/demo/Mode";
    mode.symbols = {{"IDLE", 0}, {"DRIVE", 1}, {"REVERSE", -1}};
    range.kind = TypeKind::Compound;
    range.name = "/demo/Range";
    range.fields = {{"min", &real, 0}, {"max", &real, 8}, {"mode", &mode, 16}, {"extra", &opaque, 24}};
    ranges = made_of(TypeKind::Container, range, "/std/vector");
  }
};

std::vector<Diagnostic> findings(std::string_view yaml, const Type& type, std::string_view path = "p") {
  const auto value = parse_yaml(yaml, "a.yaml");
  EXPECT_TRUE(value) << to_string(value.error());
  Diagnostics diagnostics;
  if (value) check_value(*value, type, path, "a.yaml", diagnostics);
  return diagnostics.items();
}

std::vector<std::string> messages(std::string_view yaml, const Type& type, std::string_view path = "p") {
  std::vector<std::string> texts;
  for (const Diagnostic& diagnostic : findings(yaml, type, path))
    texts.push_back(diagnostic.message);
  return texts;
}

class Conform : public ::testing::Test {
 protected:
  Types types_;
};

TEST_F(Conform, ReportsPathPlaceAndCodeApart) {
  const auto found = findings("# lidar\nmin: 0\nmax: far\n", types_.range, "properties.range");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0], (Diagnostic{Severity::Error,
                                  "type-mismatch",
                                  "properties.range.max: expected a number, got 'far'",
                                  {"a.yaml", 3, 6}}));
}

TEST_F(Conform, ReportsEveryMismatch) {
  EXPECT_THAT(messages("{min: a, max: b, mode: 1.5}", types_.range),
              ElementsAre("p.min: expected a number, got 'a'", "p.max: expected a number, got 'b'",
                          "p.mode: expected one of IDLE, DRIVE and REVERSE, got 1.5"));
}

TEST_F(Conform, CompoundsMayBePartialButNotInvented) {
  EXPECT_THAT(messages("{}", types_.range), IsEmpty());
  EXPECT_THAT(messages("{maxx: 1}", types_.range),
              ElementsAre("p: /demo/Range has no field 'maxx', did you mean 'max'?"));
  EXPECT_THAT(messages("[1]", types_.range),
              ElementsAre("p: expected a map with the fields of /demo/Range, got a list of 1"));
}

TEST_F(Conform, ANamelessRootNeedsNoPrefix) {
  EXPECT_THAT(messages("x", types_.real, ""), ElementsAre("expected a number, got 'x'"));
  EXPECT_THAT(messages("{min: x}", types_.range, ""), ElementsAre("min: expected a number, got 'x'"));
}

TEST_F(Conform, IntegersHaveARangeBySizeAndSign) {
  EXPECT_THAT(messages("255", types_.byte), IsEmpty());
  EXPECT_THAT(messages("1e2", types_.byte), IsEmpty());
  EXPECT_THAT(messages("256", types_.byte), ElementsAre("p: expected an integer from 0 to 255, got 256"));
  EXPECT_THAT(messages("-1", types_.byte), ElementsAre("p: expected an integer from 0 to 255, got -1"));
  EXPECT_THAT(messages("1.5", types_.byte), ElementsAre("p: expected an integer from 0 to 255, got 1.5"));
  EXPECT_THAT(messages("-9223372036854775808", types_.int64), IsEmpty());
  EXPECT_EQ(messages("9223372036854775808", types_.int64).size(), 1U);
  EXPECT_EQ(messages(".nan", types_.int64).size(), 1U);
  EXPECT_EQ(findings("256", types_.byte)[0].code, "out-of-range");
}

TEST_F(Conform, FloatsTakeEveryNumberTheyCanHold) {
  for (const char* number : {"1", "1.5", ".inf", ".nan", "18446744073709551615"})
    EXPECT_THAT(messages(number, types_.single), IsEmpty()) << number;
  EXPECT_THAT(messages("1e300", types_.single),
              ElementsAre("p: expected a number that a 32-bit float can hold, got 1e+300"));
  EXPECT_THAT(messages("1e300", types_.alias), IsEmpty());
}

TEST_F(Conform, BooleansAreTrueOrFalse) {
  EXPECT_THAT(messages("true", types_.boolean), IsEmpty());
  EXPECT_THAT(messages("yes", types_.boolean), ElementsAre("p: expected true or false, got 'yes'"));
  EXPECT_THAT(messages("1", types_.boolean), ElementsAre("p: expected true or false, got 1"));
}

TEST_F(Conform, TextTakesPlainScalarsAsWritten) {
  for (const char* text : {"x", "''", "1.10", "true", "0x1F"})
    EXPECT_THAT(messages(text, types_.text), IsEmpty()) << text;
  EXPECT_THAT(messages("~", types_.text), ElementsAre("p: expected text, got nothing"));
  EXPECT_THAT(messages("[a]", types_.text), ElementsAre("p: expected text, got a list of 1"));
}

TEST_F(Conform, EnumsTakeSymbolsAndTheirNumbers) {
  for (const char* mode : {"DRIVE", ":DRIVE", "':DRIVE'", "-1", "0"})
    EXPECT_THAT(messages(mode, types_.mode), IsEmpty()) << mode;
  EXPECT_THAT(messages("DRVE", types_.mode),
              ElementsAre("p: expected one of IDLE, DRIVE and REVERSE, got 'DRVE', did you mean 'DRIVE'?"));
  EXPECT_THAT(messages("7", types_.mode), ElementsAre("p: expected one of IDLE, DRIVE and REVERSE, got 7"));
}

TEST_F(Conform, DurationsAreTextOrTicks) {
  for (const char* duration : {"100ms", "2s", "250", "0s"})
    EXPECT_THAT(messages(duration, types_.milliseconds), IsEmpty()) << duration;
  EXPECT_THAT(messages("1.5s", types_.seconds), IsEmpty());
  EXPECT_THAT(messages("10us", types_.milliseconds),
              ElementsAre("p: expected a multiple of 1ms, got '10us'"));
  EXPECT_THAT(messages("soon", types_.milliseconds),
              ElementsAre("p: expected a duration such as '100ms', or a number of ticks of 1ms, got 'soon'"));
  EXPECT_EQ(messages("[1]", types_.seconds).size(), 1U);
}

TEST_F(Conform, ListsCheckTheirItems) {
  EXPECT_THAT(messages("[1, 2.5]", types_.reals), IsEmpty());
  EXPECT_THAT(messages("{data: [1, 2]}", types_.reals), IsEmpty());
  EXPECT_THAT(messages("[1, x]", types_.reals), ElementsAre("p[1]: expected a number, got 'x'"));
  EXPECT_THAT(messages("[{min: x}]", types_.ranges), ElementsAre("p[0].min: expected a number, got 'x'"));
  EXPECT_THAT(messages("{data: []}", types_.ranges), ElementsAre("p: expected a list, got a map"));
  EXPECT_THAT(messages("3", types_.reals), ElementsAre("p: expected a list, got 3"));
}

TEST_F(Conform, ArraysHaveAnExactCount) {
  EXPECT_THAT(messages("[1, 2, 3]", types_.three), IsEmpty());
  EXPECT_THAT(messages("{data: [1, 2, 3]}", types_.three), IsEmpty());
  EXPECT_THAT(messages("[1, 2]", types_.three), ElementsAre("p: expected a list of 3, got 2"));
  EXPECT_THAT(messages("1", types_.three), ElementsAre("p: expected a list of 3, got 1"));
}

TEST_F(Conform, MatricesOfAnySizeMayBeRows) {
  Type matrix;
  matrix.kind = TypeKind::Compound;
  matrix.name = "/Eigen/MatrixXd";
  matrix.fields = {{"rows", &types_.int64, 0}, {"cols", &types_.int64, 8}, {"data", &types_.reals, 16}};
  EXPECT_THAT(messages("[[1, 2], [3, 4]]", matrix), IsEmpty());
  EXPECT_THAT(messages("{rows: 1, cols: 2, data: [1, 2]}", matrix), IsEmpty());
  EXPECT_THAT(messages("[[1, x]]", matrix), ElementsAre("p[0][1]: expected a number, got 'x'"));
}

TEST_F(Conform, OptionalsMayBeNull) {
  EXPECT_THAT(messages("~", types_.maybe), IsEmpty());
  EXPECT_THAT(messages("1.5", types_.maybe), IsEmpty());
  EXPECT_THAT(messages("x", types_.maybe), ElementsAre("p: expected a number, got 'x'"));
}

TEST_F(Conform, WhatIsNotKnownAcceptsAnything) {
  EXPECT_THAT(messages("[a, {b: c}]", types_.opaque), IsEmpty());
  EXPECT_THAT(messages("{extra: [1]}", types_.range), IsEmpty());
  const Type marshalled = made_of(TypeKind::Opaque, types_.real);
  EXPECT_EQ(messages("x", marshalled).size(), 1U);
}

TEST_F(Conform, ACircleOfAliasesEnds) {
  Type circle;
  circle.kind = TypeKind::Alias;
  circle.element = &circle;
  EXPECT_THAT(messages("x", circle), IsEmpty());
}

TEST_F(Conform, LongListsOfMistakesAreCutShort) {
  const auto found = messages("[a,b,c,d,e,f,g,h,i,j,k,l,m]", types_.reals);
  EXPECT_EQ(found.size(), 11U);
  EXPECT_THAT(found.back(), ::testing::HasSubstr("from here on were not checked"));
}

}  // namespace
}  // namespace segue::type
