// SPDX-License-Identifier: Apache-2.0
#include <segue/type/type.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <utility>

namespace segue::type {
namespace {

using ::testing::HasSubstr;

std::string canonical(std::string_view name) {
  const auto result = canonical_type_name(name);
  return result ? *result : result.error().message;
}

TEST(TypeName, TakesEverySpellingInUse) {
  const std::array<std::pair<std::string_view, std::string_view>, 26> spellings = {{
      {"double", "/double"},
      {"/int", "/int32_t"},
      {"unsigned int", "/uint32_t"},
      {"/int long unsigned", "/uint64_t"},
      {"long long", "/int64_t"},
      {"char", "/int8_t"},
      {"unsigned char", "/uint8_t"},
      {"short", "/int16_t"},
      {"boost::int32_t", "/int32_t"},
      {"boost::uint16_t", "/uint16_t"},
      {"std::size_t", "/uint64_t"},
      {"/string", "/std/string"},
      {"::std::string", "/std/string"},
      {"void", "/nil"},
      {"bool", "/bool"},
      {"::base::samples::RigidBodyState", "/base/samples/RigidBodyState"},
      {"::std::vector< ::logger::StreamMetadata >", "/std/vector</logger/StreamMetadata>"},
      {"/std/vector<std/string>", "/std/vector</std/string>"},
      {"std::vector<std::vector<int> >", "/std/vector</std/vector</int32_t>>"},
      {"std::vector<double, std::allocator<double> >", "/std/vector</double>"},
      {"std::array<double, 3>", "/double[3]"},
      {"/float[20][10]", "/float[20][10]"},
      {"/nil*", "/nil*"},
      {"/struct LETTER*", "/struct LETTER*"},
      {"/Test<-2>", "/Test<-2>"},
      {"/ns/Context<int>::Parameter", "/ns/Context</int32_t>/Parameter"},
  }};
  for (const auto& [spelling, name] : spellings) {
    EXPECT_EQ(canonical(spelling), name);
    EXPECT_EQ(canonical(name), name);
  }
}

TEST(TypeName, RefusesWhatIsNoName) {
  EXPECT_THAT(canonical("/std/vector</motion_controller/Actuator"), HasSubstr("'<' that is not closed"));
  EXPECT_THAT(canonical("/std/vector<"), HasSubstr("'<' that is not closed"));
  EXPECT_THAT(canonical("/a>"), HasSubstr("'>' without '<'"));
  EXPECT_THAT(canonical("/a[3"), HasSubstr("'[' that is not closed"));
  EXPECT_THAT(canonical("/a]"), HasSubstr("']' without '['"));
  EXPECT_THAT(canonical(""), HasSubstr("ends too early"));
  EXPECT_THAT(canonical("/base/"), HasSubstr("ends too early"));
  EXPECT_THAT(canonical("/base//Pose"), HasSubstr("'/' out of place at character 7"));
  EXPECT_THAT(canonical("?/base/Pose"), HasSubstr("'?' out of place at character 1"));
  EXPECT_THAT(canonical("ndlcom message"), HasSubstr("side by side"));
  EXPECT_THAT(canonical("/a[-1]"), HasSubstr("out of place"));
  EXPECT_THAT(canonical("/3d"), HasSubstr("out of place"));
  EXPECT_THAT(canonical(std::string(5000, 'a')), HasSubstr("too long"));
  std::string deep = "a";
  for (int i = 0; i < 100; ++i)
    deep = "a<" + deep + ">";
  EXPECT_THAT(canonical(deep), HasSubstr("nested too deeply"));
}

RC_GTEST_PROP(TypeNameProperty, AnyTextIsANameOrRefusedAndNamesAreStable, ()) {
  const auto pieces = *rc::gen::container<std::vector<std::string>>(
      rc::gen::element<std::string>("/", "::", "a", "int", "long", "std", "vector", "<", ">", ",", "[3]", "*",
                                    " ", "string", "array", "-1"));
  std::string text;
  for (const std::string& piece : pieces)
    text += piece;
  const auto once = canonical_type_name(text);
  RC_CLASSIFY(once.has_value());
  if (once) RC_ASSERT(canonical_type_name(*once).value() == *once);
}

TEST(TypeRegistry, KnowsNumbersAndText) {
  TypeRegistry types;
  EXPECT_EQ(types.find("double")->size, 8U);
  EXPECT_EQ(types.find("unsigned char")->category, NumericCategory::Unsigned);
  EXPECT_EQ(types.find("bool")->category, NumericCategory::Bool);
  EXPECT_TRUE(types.find("string")->is_string());
  EXPECT_EQ(types.find("std::chrono::milliseconds")->nanoseconds_per_tick, 1'000'000);
  EXPECT_EQ(types.find("/base/Pose"), nullptr);
  EXPECT_EQ(types.find("/base/<"), nullptr);
}

TEST(TypeRegistry, BuildsArraysContainersAndPointers) {
  TypeRegistry types;
  const Type* array = types.find("double[3][2]");
  ASSERT_NE(array, nullptr);
  EXPECT_EQ(array->size, 48U);
  EXPECT_EQ(array->count, 2U);
  EXPECT_EQ(array->element->name, "/double[3]");
  EXPECT_EQ(types.find("/double[3][2]"), array);
  EXPECT_EQ(types.find("std::vector<string>")->element, types.find("/std/string"));
  EXPECT_TRUE(types.find("std::optional<int>")->is_optional());
  EXPECT_EQ(types.find("int*")->element->name, "/int32_t");
  EXPECT_EQ(std::as_const(types).find("/float[7]"), nullptr) << "only a registry that may grow builds types";
  EXPECT_EQ(types.find("/double[9999999999][9999999999]"), nullptr);
  EXPECT_EQ(types.find("/std/vector</Unknown>"), nullptr);
}

/// A compound of fields that the registry knows.
Type compound(TypeRegistry& types, std::string name,
              const std::vector<std::pair<std::string, std::string>>& fields) {
  Type type;
  type.kind = TypeKind::Compound;
  type.name = std::move(name);
  for (const auto& [field, of] : fields) {
    const Type* known = types.find(of);
    type.fields.push_back({field, known, type.size});
    type.size += known->size;
  }
  return type;
}

Type alias(const Type& of, std::string name) {
  Type type;
  type.kind = TypeKind::Alias;
  type.name = std::move(name);
  type.element = &of;
  return type;
}

TEST(TypeRegistry, RefusesASecondMeaningOfAName) {
  TypeRegistry types;
  const auto first = types.add(compound(types, "base::Pose", {{"x", "double"}}));
  ASSERT_TRUE(first);
  EXPECT_EQ((*first)->name, "/base/Pose");
  EXPECT_EQ(types.add(compound(types, "/base/Pose", {{"x", "double"}})).value(), *first);
  const auto other = types.add(compound(types, "/base/Pose", {{"x", "float"}}));
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::AlreadyExists);
  EXPECT_THAT(other.error().message, HasSubstr("/float x;"));
}

TEST(TypeRegistry, RefusesPartsThatLiveElsewhere) {
  TypeRegistry types;
  TypeRegistry elsewhere;
  EXPECT_FALSE(types.add(compound(elsewhere, "/A", {{"x", "double"}})));
  ASSERT_TRUE(types.copy(compound(elsewhere, "/A", {{"x", "double"}})));
  EXPECT_EQ(types.find("/A")->fields.at(0).type, types.find("double"));
}

TEST(TypeRegistry, RegistersTypesThatReferToEachOther) {
  TypeRegistry types;
  std::vector<std::unique_ptr<Type>> both;
  both.push_back(std::make_unique<Type>(compound(types, "/Node", {})));
  both.push_back(std::make_unique<Type>());
  *both[1] = *types.find("/std/vector</double>");
  both[1]->name = "/std/vector</Node>";
  both[1]->element = both[0].get();
  both[0]->fields.push_back({"children", both[1].get(), 0});
  ASSERT_TRUE(types.add_all(std::move(both)));
  EXPECT_EQ(types.find("/Node")->fields[0].type->element, types.find("/Node"));
  std::vector<std::unique_ptr<Type>> circle;
  circle.push_back(std::make_unique<Type>(alias(*types.find("double"), "/a")));
  circle[0]->element = circle[0].get();
  EXPECT_FALSE(types.add_all(std::move(circle)));
}

TEST(TypeRegistry, MergesAllOrNothing) {
  TypeRegistry from;
  ASSERT_TRUE(from.add(compound(from, "/A", {{"x", "std::vector<double>"}})));
  ASSERT_TRUE(from.add(compound(from, "/B", {{"a", "/A"}})));
  TypeRegistry into;
  ASSERT_TRUE(into.merge(from));
  EXPECT_EQ(into.find("/B")->fields.at(0).type, into.find("/A"));
  EXPECT_NE(into.find("/A"), from.find("/A"));
  TypeRegistry contradicting;
  ASSERT_TRUE(contradicting.add(compound(contradicting, "/B", {{"a", "float"}})));
  const std::size_t before = contradicting.types().size();
  EXPECT_FALSE(contradicting.merge(from));
  EXPECT_EQ(contradicting.types().size(), before);
}

TEST(StructuralHash, LooksThroughNamesAndAliases) {
  TypeRegistry types;
  const auto hash = [](const Type& type) { return structural_hash(type); };
  ASSERT_TRUE(types.add(alias(*types.find("double"), "/Metres")));
  const Type pose = compound(types, "/Pose", {{"x", "double"}});
  EXPECT_EQ(hash(pose), hash(compound(types, "/Other", {{"x", "double"}})));
  EXPECT_EQ(hash(pose), hash(alias(pose, "/Alias")));
  Type metres = pose;
  metres.fields[0].type = types.find("/Metres");
  EXPECT_EQ(hash(pose), hash(metres));
}

TEST(StructuralHash, IsTheSameOnEveryMachineAndInEveryVersion) {
  TypeRegistry types;
  EXPECT_EQ(structural_hash(*types.find("double")), structural_hash(*TypeRegistry().find("double")));
  EXPECT_EQ(structural_hash(compound(types, "/P", {{"x", "double"}, {"n", "string"}})),
            10800341393574239439U);
}

TEST(StructuralHash, DoesNotDependOnHowRecursionIsShared) {
  // A list node that refers to itself, and one that refers to a second node which refers back.
  Type one;
  one.kind = TypeKind::Compound;
  Type of_one;
  of_one.kind = TypeKind::Container;
  of_one.container_kind = "/std/vector";
  of_one.element = &one;
  one.fields = {{"next", &of_one, 0}};
  std::array<Type, 2> two{one, one};
  std::array<Type, 2> of_two{of_one, of_one};
  for (std::size_t i = 0; i < 2; ++i) {
    of_two.at(i).element = &two.at(1 - i);
    two.at(i).fields[0].type = &of_two.at(i);
  }
  EXPECT_EQ(structural_hash(one), structural_hash(two[0]));
  EXPECT_NE(structural_hash(one), structural_hash(of_one));
  two[1].fields[0].name = "other";
  EXPECT_NE(structural_hash(one), structural_hash(two[0]));
}

TEST(StructuralHash, IsQuickWhereTypesShareParts) {
  TypeRegistry types;
  ASSERT_TRUE(types.add(compound(types, "/c0", {{"x", "std::vector<double>"}})));
  for (int i = 1; i < 200; ++i) {
    const std::string below = "std::vector<c" + std::to_string(i - 1) + ">";
    ASSERT_TRUE(types.add(compound(types, "/c" + std::to_string(i), {{"a", below}, {"b", below}})));
  }
  EXPECT_NE(structural_hash(*types.find("/c199")), structural_hash(*types.find("/c198")));
}

using Fields = std::vector<std::pair<std::string, std::string>>;

Fields any_fields() {
  Fields fields;
  const int count = *rc::gen::inRange(1, 8);
  for (int i = 0; i < count; ++i) {
    const std::string of =
        *rc::gen::element<std::string>("double", "float", "int", "string", "double[3]", "std::vector<float>");
    fields.emplace_back("f" + std::to_string(i), of);
  }
  return fields;
}

RC_GTEST_PROP(StructuralHashProperty, ChangesWithNamesTypesAndOrderOfFields, ()) {
  TypeRegistry types;
  const Fields fields = any_fields();
  const std::uint64_t hash = structural_hash(compound(types, "/A", fields));
  TypeRegistry elsewhere;
  RC_ASSERT(hash == structural_hash(compound(elsewhere, "/B", fields)));
  const auto at = *rc::gen::inRange<std::size_t>(0, fields.size());
  Fields renamed = fields;
  renamed[at].first += "x";
  RC_ASSERT(hash != structural_hash(compound(types, "/A", renamed)));
  Fields retyped = fields;
  retyped[at].second = "unsigned char";
  RC_ASSERT(hash != structural_hash(compound(types, "/A", retyped)));
  Fields longer = fields;
  longer.emplace_back("more", "double");
  RC_ASSERT(hash != structural_hash(compound(types, "/A", longer)));
  RC_PRE(fields.size() > 1);
  Fields swapped = fields;
  std::swap(swapped.front(), swapped.back());
  RC_ASSERT(hash != structural_hash(compound(types, "/A", swapped)));
}

TEST(StructuralHash, TakesSymbolsInAnyOrder) {
  Type mode;
  mode.kind = TypeKind::Enum;
  mode.size = 4;
  mode.symbols = {{"A", 1}, {"B", 2}};
  Type sorted = mode;
  std::swap(sorted.symbols[0], sorted.symbols[1]);
  EXPECT_EQ(structural_hash(mode), structural_hash(sorted));
  sorted.symbols[0].value = 3;
  EXPECT_NE(structural_hash(mode), structural_hash(sorted));
}

TEST(Definition, ShowsATypeAndAllItIsMadeOf) {
  TypeRegistry types;
  ASSERT_TRUE(types.add(compound(types, "/base/Pose", {{"x", "double"}})));
  EXPECT_EQ(definition(compound(types, "/base/Path", {{"poses", "std::vector<base::Pose>"}, {"n", "int"}})),
            "struct /base/Path {  // 4 bytes\n"
            "  /std/vector</base/Pose> poses;  // at 0\n"
            "  /int32_t n;  // at 0\n"
            "};\n"
            "struct /base/Pose {  // 8 bytes\n"
            "  /double x;  // at 0\n"
            "};\n");
  EXPECT_EQ(definition(*types.find("double")), "/double: floating point, 8 bytes\n");
}

}  // namespace
}  // namespace segue::type
