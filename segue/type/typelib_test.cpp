// SPDX-License-Identifier: Apache-2.0
#include <segue/type/typelib.hpp>

#include <support/shared_data.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <map>
#include <utility>

namespace segue::type {
namespace {

using ::testing::HasSubstr;

const std::string kRealFiles = "rock/typelib";  // of the shared data

std::string in_typelib(const std::string& content) {
  return "<?xml version=\"1.0\"?>\n<typelib>\n" + content + "\n</typelib>\n";
}

/// The findings about a registry, each as "line: code".
std::vector<std::string> findings(const std::string& text) {
  Diagnostics diagnostics;
  const auto registry = read_typelib(text, "a.tlb", diagnostics);
  EXPECT_EQ(registry.has_value(), !diagnostics.has_errors());
  diagnostics.sort();
  std::vector<std::string> result;
  for (const Diagnostic& item : diagnostics.items()) {
    EXPECT_EQ(item.where.file, "a.tlb");
    result.push_back(std::to_string(item.where.line) + ": " + item.code);
  }
  return result;
}

std::string first_message(const std::string& content) {
  Diagnostics diagnostics;
  EXPECT_FALSE(read_typelib(in_typelib(content), "a.tlb", diagnostics));
  return diagnostics.items().empty() ? "" : diagnostics.items().front().message;
}

TypeRegistry read(const std::string& content) {
  Diagnostics diagnostics;
  auto registry = read_typelib(in_typelib(content), "a.tlb", diagnostics);
  EXPECT_TRUE(registry) << to_string(diagnostics);
  return registry ? std::move(*registry) : TypeRegistry();
}

TEST(Typelib, ReadsEveryKindOfType) {
  TypeRegistry types = read(R"(
    <numeric name="/int32_t" category="sint" size="4"/>
    <numeric name="/bool" category="uint" size="1"/>
    <null name="/nothing"/>
    <enum name="/base/Mode"><value symbol="FAST" value="2"/><value symbol="SLOW" value="-1"/></enum>
    <compound name="/base/Pose" size="40">
      <field name="mode" type="/base/Mode" offset="0"><metadata key="doc"><![CDATA[a < b]]></metadata></field>
      <field name="at" type="/double[3]" offset="8"/>
      <field name="next" type="/base/Pose*" offset="32"/>
    </compound>
    <container name="/std/vector&lt;/base/Pose&gt;" of="/base/Pose" size="24" kind="/std/vector"/>
    <opaque name="/base/Vector3d" size="0" marshal_as="/base/Pose"/>
    <opaque name="/base/Secret" size="0"/>
    <alias name="/base/Path" source="/std/vector&lt;/base/Pose&gt;"/>)");
  const Type* pose = types.find("base::Pose");
  ASSERT_NE(pose, nullptr);
  EXPECT_EQ(pose->size, 40U);
  ASSERT_EQ(pose->fields.size(), 3U);
  EXPECT_EQ(pose->fields[0].type->symbols, (std::vector<EnumSymbol>{{"FAST", 2}, {"SLOW", -1}}));
  EXPECT_EQ(pose->fields[1].type->name, "/double[3]");
  EXPECT_EQ(pose->fields[1].type->size, 24U);
  EXPECT_EQ(pose->fields[2].type->element, pose);
  EXPECT_FALSE(pose->is_complete()) << "it holds a pointer";
  EXPECT_EQ(types.find("/base/Path")->kind, TypeKind::Alias);
  EXPECT_EQ(&types.find("/base/Path")->resolved(), types.find("std::vector<base::Pose>"));
  EXPECT_EQ(types.find("/base/Vector3d")->element, pose);
  EXPECT_FALSE(types.find("/base/Secret")->is_complete());
  EXPECT_EQ(types.find("/nothing")->kind, TypeKind::Null);
  EXPECT_EQ(types.find("/bool")->category, NumericCategory::Bool);
}

TEST(Typelib, TakesForwardReferencesAndArraysOfNothing) {
  TypeRegistry types = read(R"(
    <alias name="/Later" source="/Real"/>
    <compound name="/First" size="8">
      <field name="later" type="/Later" offset="0"/>
      <field name="tail" type="/int[0]" offset="8"/>
    </compound>
    <compound name="/Real" size="8"><field name="x" type="/double" offset="0"/></compound>)");
  EXPECT_EQ(types.find("/First")->fields.at(0).type, types.find("/Real"));
  EXPECT_EQ(types.find("/First")->fields.at(1).type->name, "/int32_t[0]");
}

TEST(Typelib, TakesRecursionThroughContainers) {
  TypeRegistry types = read(R"(
    <compound name="/Node" size="24">
      <field name="children" type="/std/vector&lt;/Node&gt;" offset="0"/>
    </compound>)");
  const Type* node = types.find("/Node");
  EXPECT_EQ(node->fields.at(0).type->element, node);
  EXPECT_TRUE(node->is_complete());
}

TEST(Typelib, TakesStringsAsOldRegistriesDeclareThem) {
  for (const std::string declaration :
       {"<opaque name='/std/string'/>", "<opaque name='/std/string' size='8'/>", "<null name='/std/string'/>",
        "<container name='/std/string' of='/char' kind='/std/string'/>"}) {
    SCOPED_TRACE(declaration);
    TypeRegistry types = read(declaration + R"(
    <compound name="/Named" size="16">
      <field name="name" type="/std/string" offset="0"/>
      <field name="number" type="/int" offset="8"/>
    </compound>)");
    const Type* named = types.find("/Named");
    ASSERT_NE(named, nullptr);
    EXPECT_EQ(named->fields.at(0).type->kind, TypeKind::Container);
    EXPECT_EQ(named->fields.at(0).type->name, "/std/string");
    EXPECT_TRUE(named->is_complete());
  }
}

TEST(Typelib, RefusesAStringThatIsMarshalledAsSomethingElse) {
  EXPECT_EQ(
      findings(in_typelib("<compound name='/A' size='8'/>\n<opaque name='/std/string' marshal_as='/A'/>")),
      (std::vector<std::string>{"4: contradiction"}));
  EXPECT_EQ(findings(in_typelib("<null name='/double'/>")), (std::vector<std::string>{"3: contradiction"}));
}

TEST(Typelib, TakesContainersWithoutASize) {
  TypeRegistry types = read(R"(
    <container name="/std/vector&lt;/double&gt;" of="/double" kind="/std/vector"/>
    <compound name="/Path" size="12">
      <field name="points" type="/std/vector&lt;/double&gt;" offset="0"/>
      <field name="closed" type="/int" offset="8"/>
    </compound>)");
  const Type* points = types.find("/Path")->fields.at(0).type;
  EXPECT_EQ(points, types.find("/std/vector</double>"));
  EXPECT_EQ(points->element, types.find("/double"));
  EXPECT_TRUE(types.find("/Path")->is_complete());
}

TEST(Typelib, AFilesOwnIdeaOfLongWins) {
  TypeRegistry types = read(R"(
    <alias name="/long" source="/int32_t"/>
    <compound name="/Old" size="12">
      <field name="a" type="/long" offset="0"/>
      <field name="b" type="/long[2]" offset="4"/>
    </compound>)");
  EXPECT_EQ(types.find("/Old")->fields.at(0).type->name, "/int32_t");
  EXPECT_EQ(types.find("/Old")->fields.at(1).type->name, "/int32_t[2]");
  EXPECT_EQ(types.find("/int64_t")->size, 8U);
}

TEST(Typelib, ReportsEveryProblemWithItsPlace) {
  EXPECT_THAT(findings(in_typelib(R"(<compound name="/A" size="4">
  <field name="x" type="/Unknown" offset="0"/>
  <field name="y" type="/int" offset="two"/>
  <field name="y" offset="0"/>
</compound>
<enum name="/E"><value symbol="A" value="1"/><value symbol="A" value="2"/></enum>
<enum name="/E"/>
<numeric name="/n" category="complex" size="8"/>
<numeric name="/int16_t" category="sint" size="4"/>
<alias name="/x/" source="/A"/>
<thing name="/t"/>)")),
              ::testing::ElementsAre("4: unknown-type", "5: invalid-attribute", "6: missing-attribute",
                                     "8: duplicate-symbol", "9: duplicate-type", "10: invalid-attribute",
                                     "11: contradiction", "12: invalid-name", "13: unknown-element"));
}

TEST(Typelib, PlacesPointAtTheElement) {
  Diagnostics diagnostics;
  EXPECT_FALSE(read_typelib("<typelib>\n  <alias name='/a' source='/b'/>\n</typelib>", "x.tlb", diagnostics));
  ASSERT_EQ(diagnostics.items().size(), 1U);
  EXPECT_EQ(to_string(diagnostics.items()[0].where), "x.tlb:2:3");
  EXPECT_THAT(diagnostics.items()[0].message, HasSubstr("type '/b' is not defined in this registry"));
}

TEST(Typelib, SuggestsTheTypeThatWasMeant) {
  EXPECT_THAT(first_message("<null name='/base/Pose'/><alias name='/p' source='/base/Pos'/>"),
              HasSubstr("did you mean '/base/Pose'?"));
}

TEST(Typelib, RefusesWhatIsNoRegistry) {
  EXPECT_EQ(findings(""), (std::vector<std::string>{"0: not-xml"}));
  EXPECT_EQ(findings("<typelib>\n<a></b>"), (std::vector<std::string>{"2: not-xml"}));
  EXPECT_EQ(findings("<robot/>"), (std::vector<std::string>{"1: not-typelib"}));
  EXPECT_EQ(findings("<typelib/>"), (std::vector<std::string>{}));
}

TEST(Typelib, RefusesContradictoryLayouts) {
  EXPECT_EQ(findings(in_typelib(R"(<compound name="/A" size="8">
    <field name="x" type="/double" offset="4"/></compound>)")),
            (std::vector<std::string>{"4: field-outside"}));
  EXPECT_EQ(findings(in_typelib(R"(<compound name="/A" size="8">
    <field name="x" type="/int" offset="281474976710657"/></compound>)")),
            (std::vector<std::string>{"4: invalid-attribute"}));
  EXPECT_EQ(findings(in_typelib(R"(<compound name="/U" size="8">
    <field name="x" type="/double" offset="0"/>
    <field name="y" type="/int" offset="4"/></compound>)")),
            (std::vector<std::string>{"5: fields-overlap"}));
  EXPECT_EQ(findings(in_typelib("<compound name='/A' size='8'><field name='x' "
                                "type='/double[99999999999999999999]' offset='0'/></compound>")),
            (std::vector<std::string>{"3: unknown-type"}));
  EXPECT_EQ(findings(in_typelib("<compound name='/A' size='8'><field name='x' "
                                "type='/double[9999999999][9999999999]' offset='0'/></compound>")),
            (std::vector<std::string>{"3: too-large"}));
}

TEST(Typelib, RefusesTypesThatContainThemselves) {
  EXPECT_EQ(
      findings(in_typelib(R"(<compound name="/A" size="8"><field name="b" type="/B[2]" offset="0"/></compound>
<compound name="/B" size="4"><field name="a" type="/A[0]" offset="0"/></compound>)")),
      (std::vector<std::string>{"4: contains-itself"}));
  const auto found =
      findings(in_typelib(R"(<compound name="/A" size="8"><field name="b" type="/B" offset="0"/></compound>
<compound name="/B" size="8"><field name="a" type="/A" offset="0"/></compound>)"));
  EXPECT_EQ(found, (std::vector<std::string>{"4: contains-itself"}));
  EXPECT_EQ(findings(in_typelib("<opaque name='/O' marshal_as='/C'/>\n<compound name='/C' size='8'>"
                                "<field name='o' type='/O' offset='0'/></compound>")),
            (std::vector<std::string>{"4: contains-itself"}));
}

TEST(Typelib, RefusesAliasesOfEachOther) {
  EXPECT_THAT(findings(in_typelib("<alias name='/a' source='/b'/>\n<alias name='/b' source='/a'/>")),
              ::testing::Contains(HasSubstr("alias-circle")));
  EXPECT_EQ(findings(in_typelib("<alias name='/a' source='/a'/>")),
            (std::vector<std::string>{"3: alias-circle"}));
  EXPECT_THAT(findings(in_typelib("<alias name='/a' source='/a[2]'/>")),
              ::testing::Contains("3: alias-circle"));
}

TEST(Typelib, SurvivesHostileDepth) {
  std::string aliases;
  std::string nested = "<compound name='/c0' size='8'/>\n";
  for (int i = 1; i < 20000; ++i) {
    const std::string name = std::to_string(i);
    aliases += "<alias name='/a" + std::to_string(i - 1) + "' source='/a" + name + "'/>\n";
    nested += "<compound name='/c" + name + "' size='8'><field name='x' type='/c" + std::to_string(i - 1) +
              "' offset='0'/></compound>\n";
  }
  EXPECT_THAT(findings(in_typelib(aliases + "<alias name='/a19999' source='/int'/>")),
              ::testing::Contains(HasSubstr("alias-circle")));
  EXPECT_THAT(findings(in_typelib(nested)), ::testing::ElementsAre(HasSubstr("too-deep")));
  std::string deep = "/int";
  for (int i = 0; i < 1000; ++i)
    deep += "[1]";
  EXPECT_EQ(findings(in_typelib("<alias name='/a' source='" + deep + "'/>")),
            (std::vector<std::string>{"3: invalid-name"}));
  std::string elements;
  for (int i = 0; i < 50000; ++i)
    elements += "<a>";
  EXPECT_EQ(findings("<typelib>" + elements), (std::vector<std::string>{"1: not-xml"}));
}

RC_GTEST_PROP(TypelibProperty, DamagedRegistriesAreReadOrRefusedButNeverCrash, ()) {
  std::string text = in_typelib(R"(<numeric name="/int32_t" category="sint" size="4"/>
<enum name="/E"><value symbol="A" value="1"/></enum>
<compound name="/A" size="24"><field name="x" type="/E[3]" offset="0"/><field name="y" type="/B" offset="16"/></compound>
<alias name="/B" source="/int32_t*"/><opaque name="/O" size="0" marshal_as="/A"/>)");
  const int damages = *rc::gen::inRange(1, 8);
  for (int i = 0; i < damages; ++i) {
    const auto at = *rc::gen::inRange<std::size_t>(0, text.size());
    const std::string piece =
        *rc::gen::element<std::string>("", "\"", "<", ">", "/A", "[0]", "0", "9", "*", "/>");
    text.replace(at, *rc::gen::inRange<std::size_t>(0, 6), piece);
  }
  Diagnostics diagnostics;
  const auto registry = read_typelib(text, "damaged.tlb", diagnostics);
  RC_ASSERT(registry.has_value() != diagnostics.has_errors());
}

/// How many elements of each kind a file has, counted by hand (grep).
struct Counted {
  std::size_t compounds;
  std::size_t enums;
  std::size_t opaques;
  std::size_t warnings = 0;
};
const std::map<std::string, Counted> kCounted = {
    {"orogen_test_ros_models_base.tlb", {66, 10, 15}},
    {"orogen_test_ros_models_std.tlb", {3, 0, 0}},
    {"typelib_test_rflex.tlb", {62, 17, 0, 6}},  // a 32-bit machine's long
    {"typelib_test_ruby_cxx_import_tests_arrays.tlb", {4, 0, 0}},
    {"typelib_test_ruby_cxx_import_tests_classes.tlb", {10, 0, 3}},
    {"typelib_test_ruby_cxx_import_tests_enums.tlb", {4, 3, 0}},
    {"typelib_test_ruby_cxx_import_tests_opaques.tlb", {1, 0, 4}},
    {"typelib_test_ruby_cxx_import_tests_stdheaders.tlb", {0, 0, 0}},
    {"typelib_test_ruby_cxx_import_tests_stdvector.tlb", {6, 0, 0}},
    {"typelib_test_ruby_tlb_import_tests_templates.tlb", {0, 0, 1}},
    {"typelib_test_test_cimport.tlb", {21, 3, 0}},
};

std::size_t count(const TypeRegistry& registry, TypeKind kind) {
  const std::vector<const Type*> types = registry.types();
  return static_cast<std::size_t>(std::ranges::count(types, kind, &Type::kind));
}

TEST(TypelibSharedData, AllAreRead) {
  if (const auto missing = missing_shared_data(kRealFiles); !missing.empty()) GTEST_SKIP() << missing;
  std::size_t files = 0;
  TypeRegistry all;
  for (const auto& entry : std::filesystem::directory_iterator(shared_data(kRealFiles))) {
    SCOPED_TRACE(entry.path().filename());
    ++files;
    Diagnostics diagnostics;
    const auto registry = load_typelib(entry.path(), diagnostics);
    ASSERT_TRUE(registry) << to_string(diagnostics);
    const auto counted = kCounted.find(entry.path().filename());
    const Counted expected = counted == kCounted.end() ? Counted{} : counted->second;
    EXPECT_EQ(diagnostics.items().size(), expected.warnings) << to_string(diagnostics);
    if (counted == kCounted.end()) continue;
    EXPECT_EQ(count(*registry, TypeKind::Compound), expected.compounds);
    EXPECT_EQ(count(*registry, TypeKind::Enum), expected.enums);
    EXPECT_EQ(count(*registry, TypeKind::Opaque), expected.opaques);
  }
  EXPECT_EQ(files, 31U);
}

std::optional<TypeRegistry> real(const std::string& name) {
  Diagnostics diagnostics;
  return load_typelib(shared_data(kRealFiles) / name, diagnostics);
}

TEST(TypelibSharedData, RockTypesAreAsTheyShouldBe) {
  if (const auto missing = missing_shared_data(kRealFiles); !missing.empty()) GTEST_SKIP() << missing;
  auto types = real("orogen_test_ros_models_base.tlb");
  ASSERT_TRUE(types);
  const Type* state = types->find("base::samples::RigidBodyState_m");
  ASSERT_NE(state, nullptr);
  EXPECT_EQ(state->size, 416U);
  EXPECT_EQ(state->fields.size(), 11U);
  EXPECT_TRUE(state->is_complete());
  EXPECT_EQ(&types->find("/base/Position")->resolved(), types->find("/base/Vector3d"));
  EXPECT_EQ(types->find("/base/Vector3d")->kind, TypeKind::Opaque);
  EXPECT_EQ(types->find("/base/Vector3d")->element->name, "/wrappers/Matrix</double,3,1>");
  EXPECT_EQ(types->find("/std/vector</unsigned char>"), types->find("std::vector<uint8_t>"));
}

TEST(TypelibSharedData, EveryTypeIsFoundByItsOwnNameAndHasADefinition) {
  if (const auto missing = missing_shared_data(kRealFiles); !missing.empty()) GTEST_SKIP() << missing;
  for (const auto& entry : std::filesystem::directory_iterator(shared_data(kRealFiles))) {
    auto registry = real(entry.path().filename());
    ASSERT_TRUE(registry);
    for (const Type* type : registry->types()) {
      EXPECT_EQ(registry->find(type->name), type) << type->name;
      EXPECT_THAT(definition(*type), HasSubstr(type->name));
    }
    TypeRegistry copy;
    const auto merged = copy.merge(*registry);
    ASSERT_TRUE(merged) << merged.error().message;
    for (const Type* type : registry->types())
      EXPECT_EQ(structural_hash(*copy.find(type->name)), structural_hash(*type)) << type->name;
  }
}

}  // namespace
}  // namespace segue::type
