// SPDX-License-Identifier: Apache-2.0
#include <segue/type/describe.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cstring>
#include <limits>
#include <map>
#include <thread>

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::StartsWith;

namespace demo {
enum class Mode { Slow, Medium = 3, Fast = 7 };
enum Plain : std::uint8_t { PLAIN_A = 1, PLAIN_B = 200 };
struct Pose {
  double x = 0;
  double y = 0;
  float theta = 0;
  friend bool operator==(const Pose&, const Pose&) = default;
};
struct Range {
  double min = 0;
  double max = 30;
};
struct Base {
  int id = 1;
};
struct Everything : Base {
  Pose pose;
  Mode mode = Mode::Slow;
  std::array<double, 3> axis{};
  std::uint8_t raw[2][3] = {};
  std::optional<Pose> goal;
  std::chrono::milliseconds period{100};
  std::string name = "none";
  std::vector<bool> bits;
  std::vector<Pose> path;
  Range range;
  char letter = 'a';
  std::int8_t small = 0;
  std::uint64_t large = 0;
  float narrow = 0;
  bool flag = false;
  Plain plain = PLAIN_A;
};
struct Node {
  int value = 0;
  std::vector<Node> children;
  friend bool operator==(const Node&, const Node&) = default;
};
/// Two types that contain each other.
struct Even;
struct Odd {
  std::vector<Even> evens;
};
struct Even {
  std::vector<Odd> odds;
  std::optional<std::vector<Odd>> more;
};
struct Hidden {
  int shown = 0;
  const char* pointer = nullptr;
};
struct Empty {};
struct Sixty {
  int a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, c0, c1, c2, c3, c4, c5,
      c6, c7, c8, c9, d0, d1, d2, d3, d4, d5, d6, d7, d8, d9, e0, e1, e2, e3, e4, e5, e6, e7, e8, e9, f0, f1,
      f2, f3, f4, f5, f6, f7, f8, f9, g0, g1, g2, g3;
};
struct NeverAsked {
  int value = 0;
};
struct Within : Pose {
  struct Part {
    int value = 0;
  };
  std::array<Part, 2> parts;
};
template <int N>
struct Sized {
  int value = N;
};
enum class Turn { Left, Right };
SEGUE_TYPE(Within, x, parts)
SEGUE_TYPE(Within::Part, value)
SEGUE_TYPE(Sized<3>, value)
SEGUE_TYPE(Turn, Left, Right)

namespace {
struct Unnamed {
  int value = 0;
};
SEGUE_TYPE(Unnamed, value)
}  // namespace
}  // namespace demo

// Before the types it is made of: the order does not matter.
SEGUE_TYPE(demo::Everything, id, pose, mode, axis, raw, goal, period, name, bits, path, range, letter, small,
           large, narrow, flag, plain)
SEGUE_TYPE(demo::Pose, x, y, theta)
SEGUE_TYPE(demo::Range, min, max)
SEGUE_TYPE(demo::Mode, Slow, Medium, Fast)
SEGUE_TYPE(demo::Plain, PLAIN_A, PLAIN_B)
SEGUE_TYPE(demo::Node, value, children)
SEGUE_TYPE(demo::Odd, evens)
SEGUE_TYPE(demo::Even, odds, more)
SEGUE_TYPE(demo::Hidden, shown)
SEGUE_TYPE(demo::Empty)
SEGUE_TYPE(demo::Sixty, a0, a1, a2, a3, a4, a5, a6, a7, a8, a9, b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, c0,
           c1, c2, c3, c4, c5, c6, c7, c8, c9, d0, d1, d2, d3, d4, d5, d6, d7, d8, d9, e0, e1, e2, e3, e4, e5,
           e6, e7, e8, e9, f0, f1, f2, f3, f4, f5, f6, f7, f8, f9, g0, g1, g2, g3)
SEGUE_TYPE(demo::NeverAsked, value)

namespace segue::type {
namespace {

template <class T>
Result<void> assign(T& object, const Value& value, std::string_view path = "properties") {
  return type_info<T>().from_value(&object, value, path);
}

template <class T>
Value value_of(const T& object) {
  return type_info<T>().to_value(&object);
}

template <class T>
std::string refusal(const Value& value, T object = {}) {
  const auto done = assign(object, value);
  return done ? "accepted" : done.error().message;
}

TEST(Describe, IsWrittenInTheNamespaceOfTheTypeOrAtGlobalScope) {
  EXPECT_EQ(type_info<demo::Within>().name(), "/demo/Within");
  EXPECT_EQ(type_info<demo::Within::Part>().name(), "/demo/Within/Part");
  EXPECT_EQ(type_info<demo::Sized<3>>().name(), "/demo/Sized<3>");
  EXPECT_EQ(type_info<demo::Turn>().name(), "/demo/Turn");
  EXPECT_EQ(type_info<demo::Unnamed>().name(), "/demo/Unnamed");
  struct Derived : demo::Pose {};
  static_assert(detail::Described<demo::Pose> && !detail::Described<Derived>);
}

TEST(Describe, NamesTypesAsTypelibDoes) {
  EXPECT_EQ(type_info<demo::Pose>().name(), "/demo/Pose");
  EXPECT_EQ(type_info<int>().name(), "/int32_t");
  EXPECT_EQ(type_info<long>().name(), "/int64_t");
  EXPECT_EQ(type_info<long long>().name(), "/int64_t");
  EXPECT_EQ(type_info<unsigned short>().name(), "/uint16_t");
  EXPECT_EQ(type_info<char>().name(), "/int8_t");
  EXPECT_EQ(type_info<bool>().name(), "/bool");
  EXPECT_EQ(type_info<std::string>().name(), "/std/string");
  EXPECT_EQ(type_info<std::vector<double>>().name(), "/std/vector</double>");
  EXPECT_EQ((type_info<std::array<double, 3>>().name()), "/double[3]");
  EXPECT_EQ((type_info<std::array<std::array<double, 3>, 2>>().name()), "/double[3][2]");
  EXPECT_EQ(type_info<std::optional<double>>().name(), "/std/optional</double>");
  EXPECT_EQ(type_info<std::vector<std::vector<demo::Mode>>>().name(), "/std/vector</std/vector</demo/Mode>>");
  EXPECT_EQ(type_info<std::chrono::nanoseconds>().name(), "/std/chrono/nanoseconds");
  EXPECT_EQ((type_info<std::chrono::duration<double, std::milli>>().name()),
            "/std/chrono/duration</double,1,1000>");
  EXPECT_EQ(type_info<std::chrono::steady_clock::time_point>().name(),
            "/std/chrono/time_point</std/chrono/steady_clock,/std/chrono/nanoseconds>");
}

TEST(Describe, ACanonicalNameIsItsOwnCanonicalName) {
  for (const TypeInfo* info : {&type_info<std::vector<demo::Mode>>(), &type_info<std::optional<double>>(),
                               &type_info<std::chrono::system_clock::time_point>(),
                               &type_info<std::array<std::array<char, 3>, 2>>()}) {
    EXPECT_EQ(canonical_type_name(info->name()).value(), info->name());
  }
}

TEST(Describe, ListsMembersWithTheirOffsets) {
  const Type& type = *type_info<demo::Pose>().type;
  ASSERT_EQ(type.kind, TypeKind::Compound);
  ASSERT_EQ(type.fields.size(), 3U);
  EXPECT_EQ(type.fields[1].name, "y");
  EXPECT_EQ(type.fields[1].offset, offsetof(demo::Pose, y));
  EXPECT_EQ(type.fields[2].offset, offsetof(demo::Pose, theta));
  EXPECT_EQ(type.fields[2].type->name, "/float");
  EXPECT_EQ(type.size, sizeof(demo::Pose));
}

TEST(Describe, TakesSixtyFourMembers) {
  const Type& type = *type_info<demo::Sixty>().type;
  ASSERT_EQ(type.fields.size(), 64U);
  EXPECT_EQ(type.fields.back().name, "g3");
  EXPECT_EQ(type.fields.back().offset, 63 * sizeof(int));
}

TEST(Describe, ListsSymbolsOfScopedAndPlainEnums) {
  const Type& mode = *type_info<demo::Mode>().type;
  EXPECT_EQ(mode.kind, TypeKind::Enum);
  EXPECT_EQ(mode.symbols, (std::vector<EnumSymbol>{{"Slow", 0}, {"Medium", 3}, {"Fast", 7}}));
  const Type& plain = *type_info<demo::Plain>().type;
  EXPECT_EQ(plain.symbols, (std::vector<EnumSymbol>{{"PLAIN_A", 1}, {"PLAIN_B", 200}}));
  EXPECT_EQ(plain.size, 1U);
}

TEST(Describe, HandlesTypesThatContainThemselves) {
  const Type& node = *type_info<demo::Node>().type;
  EXPECT_EQ(node.fields[1].type->element, &node);
  EXPECT_NE(type_info<demo::Node>().hash, 0U);
  const Type& even = *type_info<std::vector<demo::Even>>().type->element;
  EXPECT_EQ(even.fields[1].type->element->name, "/std/vector</demo/Odd>");
  EXPECT_EQ(even.fields[0].type->element->fields[0].type->element, &even);
  EXPECT_TRUE(even.is_complete());
}

TEST(Describe, BytesTravelOnlyWhereEveryByteIsDescribed) {
  EXPECT_TRUE(type_info<demo::Pose>().trivially_copyable);
  EXPECT_TRUE((type_info<std::array<demo::Pose, 4>>().trivially_copyable));
  EXPECT_TRUE(type_info<demo::Mode>().trivially_copyable);
  EXPECT_TRUE(type_info<demo::Sixty>().trivially_copyable);
  EXPECT_FALSE(type_info<demo::Hidden>().trivially_copyable) << "a member that was not named is a pointer";
  EXPECT_FALSE(type_info<demo::Everything>().trivially_copyable);
  EXPECT_FALSE(type_info<std::string>().trivially_copyable);
  EXPECT_FALSE(type_info<std::vector<double>>().trivially_copyable);
}

TEST(Describe, FindsTypesByNameEvenIfNothingUsedThem) {
  const TypeInfo* found = find_type_info("/demo/NeverAsked");
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found, &type_info<demo::NeverAsked>());
  EXPECT_EQ(find_type_info("demo::NeverAsked"), found);
  EXPECT_EQ(find_type_info("/demo/Nothing"), nullptr);
  EXPECT_EQ(find_type_info("/demo/<"), nullptr);
}

TEST(Describe, CanBeAskedFromManyThreads) {
  std::vector<std::thread> threads;
  std::vector<const TypeInfo*> found(8);
  for (std::size_t i = 0; i < found.size(); ++i) {
    threads.emplace_back([&found, i] {
      found[i] = i % 2 == 0 ? &type_info<std::vector<std::array<demo::Everything, 2>>>()
                            : find_type_info("/std/vector</demo/Everything[2]>");
    });
  }
  for (std::thread& thread : threads)
    thread.join();
  for (std::size_t i = 0; i < found.size(); i += 2)
    EXPECT_EQ(found[i], (&type_info<std::vector<std::array<demo::Everything, 2>>>()));
}

TEST(Describe, ConstructsCopiesAndDestroys) {
  const TypeInfo& info = type_info<demo::Everything>();
  alignas(demo::Everything) std::array<std::byte, sizeof(demo::Everything)> memory{};
  info.construct(memory.data());
  auto& object = *reinterpret_cast<demo::Everything*>(memory.data());
  EXPECT_EQ(object.period, 100ms);
  demo::Everything other;
  other.name = "a name that does not fit into the string itself";
  other.raw[1][2] = 9;
  info.copy(&object, &other);
  EXPECT_EQ(object.name, other.name);
  EXPECT_EQ(object.raw[1][2], 9);
  info.destroy(memory.data());
}

TEST(Describe, CopyingReusesCapacity) {
  std::vector<double> to(1000);
  const std::vector<double> from(10, 1.5);
  const double* storage = to.data();
  type_info<std::vector<double>>().copy(&to, &from);
  EXPECT_EQ(to, from);
  EXPECT_EQ(to.data(), storage);
}

TEST(Describe, ReadsNestedValues) {
  demo::Everything object;
  const Value value = Value::map({{"id", 5},
                                  {"pose", Value::map({{"x", 1}, {"theta", 0.5}})},
                                  {"mode", "Fast"},
                                  {"axis", Value::list({1, 2, 3.5})},
                                  {"raw", Value::list({Value::list({1, 2, 3}), Value::list({4, 5, 6})})},
                                  {"goal", Value::map({{"y", -1}})},
                                  {"period", "1.5s"},
                                  {"bits", Value::list({true, false})},
                                  {"path", Value::list({Value::map({{"x", 9}})})},
                                  {"plain", 200}});
  const auto done = assign(object, value);
  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(object.id, 5);
  EXPECT_EQ(object.pose, (demo::Pose{1, 0, 0.5F}));
  EXPECT_EQ(object.mode, demo::Mode::Fast);
  EXPECT_EQ(object.axis[2], 3.5);
  EXPECT_EQ(object.raw[1][0], 4);
  EXPECT_EQ(object.goal, (demo::Pose{0, -1, 0}));
  EXPECT_EQ(object.period, 1500ms);
  EXPECT_EQ(object.bits, (std::vector<bool>{true, false}));
  EXPECT_EQ(object.path.at(0).x, 9);
  EXPECT_EQ(object.plain, demo::PLAIN_B);
  EXPECT_EQ(object.name, "none") << "what is absent stays";
}

TEST(Describe, AnObjectStaysAsItWasWhenAValueIsRefused) {
  demo::Everything object;
  object.path.resize(3);
  const Value before = value_of(object);
  EXPECT_FALSE(assign(object, Value::map({{"id", 7}, {"path", Value::list({})}, {"name", Value::list({})}})));
  EXPECT_EQ(value_of(object), before);
}

TEST(Describe, SaysWhatWasExpectedAndWhere) {
  demo::Everything object;
  Value far = "far";
  far.set_mark({12, 14});
  const auto done = assign(object, Value::map({{"range", Value::map({{"max", far}})}}));
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().message, "properties.range.max: expected a number, got 'far'");
  EXPECT_EQ(done.error().where.line, 12);
  EXPECT_EQ(done.error().where.column, 14);
  EXPECT_EQ(refusal<demo::Everything>(Value::map({{"axis", Value::list({1, "b", 3})}})),
            "properties.axis[1]: expected a number, got 'b'");
  EXPECT_EQ(refusal<demo::Everything>(Value::map({{"axis", Value::list({1})}})),
            "properties.axis: expected a list of 3, got a list of 1");
  EXPECT_THAT(refusal<demo::Everything>(Value::map({{"periode", "1s"}})),
              HasSubstr("/demo/Everything has no member 'periode', did you mean 'period'?"));
  EXPECT_THAT(refusal<demo::Mode>("Fats"),
              HasSubstr("expected one of Slow, Medium and Fast, got 'Fats', did you mean 'Fast'"));
  EXPECT_THAT(refusal<demo::Mode>(4), HasSubstr("expected one of Slow, Medium and Fast, got 4"));
  EXPECT_THAT(refusal<demo::Pose>(Value()), HasSubstr("expected a map, got nothing"));
  EXPECT_THAT(refusal<bool>(1), HasSubstr("expected true or false, got 1"));
  EXPECT_EQ(refusal<std::vector<bool>>(Value::list({true, 2})),
            "properties[1]: expected true or false, got 2");
}

TEST(Describe, RefusesIntegersOutOfRange) {
  EXPECT_EQ(refusal<std::uint8_t>(300), "properties: expected an integer from 0 to 255, got 300");
  EXPECT_EQ(refusal<std::uint8_t>(-1), "properties: expected an integer from 0 to 255, got -1");
  EXPECT_EQ(refusal<std::int8_t>(-129), "properties: expected an integer from -128 to 127, got -129");
  EXPECT_EQ(refusal<std::int8_t>(-128), "accepted");
  EXPECT_EQ(refusal<std::int64_t>(std::numeric_limits<std::int64_t>::min()), "accepted");
  EXPECT_EQ(refusal<std::uint64_t>(std::numeric_limits<std::uint64_t>::max()), "accepted");
  EXPECT_THAT(refusal<std::int64_t>(std::numeric_limits<std::uint64_t>::max()), HasSubstr("expected a"));
  EXPECT_THAT(refusal<std::int64_t>(1e19), HasSubstr("expected a"));
  EXPECT_THAT(refusal<std::int64_t>(std::numeric_limits<double>::quiet_NaN()), HasSubstr("expected a"));
  EXPECT_THAT(refusal<std::int32_t>(1.5),
              HasSubstr("expected an integer from -2147483648 to 2147483647, got 1.5"));
  EXPECT_EQ(refusal<std::int32_t>(10.0), "accepted");
  EXPECT_THAT(refusal<float>(1e300), HasSubstr("expected a"));
  EXPECT_EQ(refusal<float>(std::numeric_limits<double>::infinity()), "accepted");
}

TEST(Describe, DurationsTakeTextWithAUnitOrTicks) {
  std::chrono::milliseconds period{};
  ASSERT_TRUE(assign(period, 250));
  EXPECT_EQ(period, 250ms);
  ASSERT_TRUE(assign(period, "2s"));
  EXPECT_EQ(period, 2s);
  EXPECT_EQ(refusal<std::chrono::milliseconds>("1us"), "properties: expected a multiple of 1ms, got '1us'");
  EXPECT_THAT(refusal<std::chrono::milliseconds>("soon"), HasSubstr("expected a duration such as '100ms'"));
  EXPECT_THAT(refusal<std::chrono::milliseconds>(Value::list({})), HasSubstr("a duration such as '100ms'"));
  std::chrono::duration<double> seconds{};
  ASSERT_TRUE(assign(seconds, "250ms"));
  EXPECT_EQ(seconds.count(), 0.25);
  EXPECT_EQ(type_info<std::chrono::milliseconds>().type->nanoseconds_per_tick, 1'000'000);
}

TEST(Describe, EnumsTakeSymbolsAsRockWritesThem) {
  demo::Mode mode{};
  ASSERT_TRUE(assign(mode, ":Medium"));
  EXPECT_EQ(mode, demo::Mode::Medium);
  EXPECT_EQ(value_of(mode), Value("Medium"));
  EXPECT_EQ(value_of(static_cast<demo::Mode>(5)), Value(5)) << "numbers without a symbol stay visible";
}

TEST(Describe, StringsTakeScalarsAsTheyWereWritten) {
  std::string text;
  Value version = 1.1;
  version.set_source_text("1.10");
  ASSERT_TRUE(assign(text, version));
  EXPECT_EQ(text, "1.10");
  ASSERT_TRUE(assign(text, 17));
  EXPECT_EQ(text, "17");
  ASSERT_TRUE(assign(text, true));
  EXPECT_EQ(text, "true");
  EXPECT_THAT(refusal<std::string>(Value()), HasSubstr("expected text, got nothing"));
}

TEST(Describe, OptionalMembersAreNothingOrAValue) {
  demo::Everything object;
  EXPECT_TRUE(value_of(object).find("goal")->is_null());
  ASSERT_TRUE(assign(object, Value::map({{"goal", Value::map({{"x", 1}})}})));
  ASSERT_TRUE(assign(object, Value::map({{"goal", Value::map({{"y", 2}})}})));
  EXPECT_EQ(object.goal, (demo::Pose{1, 2, 0})) << "a compound given in part keeps the rest";
  ASSERT_TRUE(assign(object, Value::map({{"goal", Value()}})));
  EXPECT_FALSE(object.goal.has_value());
}

TEST(Describe, ItemsOfAListStartFromTheirDefaults) {
  std::vector<demo::Range> ranges{{5, 6}};
  ASSERT_TRUE(assign(ranges, Value::list({Value::map({{"min", 1}})})));
  EXPECT_EQ(ranges.at(0).min, 1);
  EXPECT_EQ(ranges.at(0).max, 30);
}

TEST(Describe, ListsOfNumbersMayBeWrittenAsRockDoes) {
  std::array<double, 3> axis{};
  ASSERT_TRUE(assign(axis, Value::map({{"data", Value::list({1, 2, 3})}})));
  EXPECT_EQ(axis[2], 3);
}

TEST(Describe, AnEmptyStructIsAnEmptyMap) {
  demo::Empty empty;
  EXPECT_EQ(value_of(empty), Value(ValueMap{}));
  EXPECT_TRUE(assign(empty, ValueMap{}));
}

demo::Node any_node(int depth) {
  demo::Node node{*rc::gen::arbitrary<int>(), {}};
  const int children = depth == 0 ? 0 : *rc::gen::inRange(0, 4);
  for (int i = 0; i < children; ++i)
    node.children.push_back(any_node(depth - 1));
  return node;
}

RC_GTEST_PROP(DescribeProperty, ValuesAndObjectsConvertBackAndForth, ()) {
  const demo::Node node = any_node(3);
  demo::Node copy;
  RC_ASSERT(assign(copy, value_of(node)).has_value());
  RC_ASSERT(copy == node);
}

RC_GTEST_PROP(DescribeProperty, NumbersOfEverySizeConvertBackAndForth,
              (std::int8_t small, std::uint64_t large, float narrow, double x, bool flag, std::string name)) {
  demo::Everything object;
  object.small = small;
  object.large = large;
  object.narrow = narrow;
  object.pose.x = x;
  object.flag = flag;
  object.name = name;
  object.goal = flag ? std::optional<demo::Pose>({x, x, narrow}) : std::nullopt;
  object.bits = {flag, !flag};
  demo::Everything copy;
  RC_ASSERT(assign(copy, value_of(object)).has_value());
  RC_ASSERT(value_of(copy) == value_of(object));
  RC_ASSERT(copy.large == large && copy.small == small && copy.narrow == narrow && copy.name == name);
}

}  // namespace
}  // namespace segue::type
