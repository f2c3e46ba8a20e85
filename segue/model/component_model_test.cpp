// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/model/files.hpp>
#include <segue/model/port_pattern.hpp>

#include <support/shared_data.hpp>

#include <gmock/gmock.h>

#include <filesystem>
#include <set>

namespace segue::model {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using type::Value;
namespace fs = std::filesystem;

constexpr const char* kFilter = R"(components:
  demo::Filter:
    doc: Keeps what is near.
    library: segue_components_demo
    ports:
      - {name: input, direction: input, type: /demo/Cloud}
      - {name: output, direction: output, type: "/std/vector</demo/Cloud>", dynamic: true}
      - {pattern: "debug_.*", direction: output, type: /std/string}
    properties:
      - {name: mode, type: /demo/Mode, default: Fast, live: true}
      - {name: range, type: /double, default: 30.0, doc: metres}
    operations:
      - {name: reset, arguments: [{name: hard, type: /bool}], result: /bool, caller_thread: true}
    activity: {periodic: 20ms, scheduler: fifo, priority: 10}
    trigger_ports: [input]
    descriptors: [device]
    nominal_states: [IDLE]
    error_states: [BLIND]
    exclusive: [/dev/lidar]
types:
  /demo/Mode: {kind: enum, size: 4, symbols: {Fast: 0, Slow: -1}}
  /demo/Point: {kind: compound, size: 16, fields: [{name: x, type: /double, offset: 0}, {name: y, type: /double, offset: 8}]}
  /demo/Cloud: {kind: compound, size: 32, fields: [{name: points, type: "/std/vector</demo/Point>", offset: 0}, {name: ids, type: "/uint8_t[4]", offset: 24}]}
)";

ComponentCatalog read_all(std::string_view text, Diagnostics& diagnostics) {
  ComponentCatalog catalog;
  read_components(text, "c.yaml", catalog, diagnostics);
  return catalog;
}

TEST(ComponentFileTest, ReadsAllFields) {
  Diagnostics diagnostics;
  const ComponentCatalog catalog = read_all(kFilter, diagnostics);
  ASSERT_THAT(diagnostics.items(), IsEmpty()) << to_string(diagnostics);
  const ComponentModel* model = catalog.find(ComponentName("demo::Filter"));
  ASSERT_NE(model, nullptr);
  EXPECT_EQ(model->library, "segue_components_demo");
  ASSERT_NE(model->find_port("input", Direction::Input), nullptr);
  EXPECT_EQ(model->find_port("input", Direction::Output), nullptr);
  EXPECT_TRUE(model->find_port("output", Direction::Output)->dynamic);
  EXPECT_TRUE(model->find_port("debug_x", Direction::Output)->pattern);
  EXPECT_EQ(model->find_port("undebug_x", Direction::Output), nullptr);
  EXPECT_EQ(model->find_port("state", Direction::Output)->type, "/int32_t");
  EXPECT_TRUE(model->find_property("mode")->live);
  EXPECT_TRUE(model->operations.at(0).caller_thread);
  EXPECT_EQ(model->activity.period, std::chrono::milliseconds(20));
  EXPECT_TRUE(model->has_dynamic_ports());
  const type::Type* cloud = catalog.types().find("/demo/Cloud");
  ASSERT_NE(cloud, nullptr);
  EXPECT_EQ(cloud->fields.at(0).type->element->name, "/demo/Point");
  EXPECT_EQ(cloud->fields.at(1).type->count, 4U);
  EXPECT_NE(catalog.types().find("/std/vector</demo/Cloud>"), nullptr);
}

TEST(ComponentFileTest, OneComponentNeedsNoMap) {
  Diagnostics diagnostics;
  const ComponentCatalog catalog =
      read_all("component: demo::Relay\nports: [{name: in, direction: input, type: double}]\n", diagnostics);
  ASSERT_THAT(diagnostics.items(), IsEmpty()) << to_string(diagnostics);
  EXPECT_EQ(catalog.find(ComponentName("demo::Relay"))->find_port("in", Direction::Input)->type, "/double");
}

/// Writes the models and types of `catalog` and reads them again.
void expect_round_trip(const ComponentCatalog& catalog) {
  std::vector<ComponentName> names;
  for (const ComponentModel* model : catalog.all())
    names.push_back(model->name);
  const std::string text = write_components(catalog, names);
  Diagnostics diagnostics;
  const ComponentCatalog again = read_all(text, diagnostics);
  ASSERT_THAT(diagnostics.items(), IsEmpty()) << to_string(diagnostics) << text;
  ASSERT_EQ(again.size(), catalog.size());
  for (const ComponentModel* model : catalog.all())
    EXPECT_EQ(*again.find(model->name), *model) << text;
  for (const type::Type* type : again.types().types()) {
    const type::Type* original = catalog.types().find(type->name);
    ASSERT_NE(original, nullptr) << type->name;
    EXPECT_EQ(type::structural_hash(*type), type::structural_hash(*original)) << type->name;
  }
  EXPECT_EQ(write_components(again, names), text);
}

TEST(ComponentFileTest, WritingIsTheInverse) {
  Diagnostics diagnostics;
  expect_round_trip(read_all(kFilter, diagnostics));
}

TEST(ComponentFileTest, RecursiveTypesSurvive) {
  Diagnostics diagnostics;
  const ComponentCatalog catalog = read_all(R"(components:
  demo::Tree: {ports: [{name: out, direction: output, type: /demo/Node}]}
types:
  /demo/Node: {kind: compound, size: 24, fields: [{name: children, type: "/std/vector</demo/Node>", offset: 0}]}
)",
                                            diagnostics);
  ASSERT_THAT(diagnostics.items(), IsEmpty()) << to_string(diagnostics);
  expect_round_trip(catalog);
}

TEST(ComponentFileTest, ContradictionsAreErrors) {
  Diagnostics diagnostics;
  ComponentCatalog catalog = read_all(kFilter, diagnostics);
  EXPECT_FALSE(read_components("types: {/demo/Point: {kind: enum, symbols: {A: 0}}}", "other.yaml", catalog,
                               diagnostics));
  EXPECT_THAT(to_string(diagnostics), HasSubstr("type-conflict"));
}

TEST(ComponentFileTest, UnknownPartsOfTypesAreErrors) {
  Diagnostics diagnostics;
  read_all("types: {/demo/A: {kind: compound, fields: [{name: x, type: /demo/B}]}}", diagnostics);
  EXPECT_THAT(to_string(diagnostics), HasSubstr("unknown-type"));
}

TEST(PortPatternTest, HostileExpressionsAreRefusedOrQuick) {
  EXPECT_FALSE(check_port_pattern("("));
  EXPECT_FALSE(check_port_pattern(std::string(300, 'a')));
  EXPECT_FALSE(check_port_pattern("((a{99}){99}){99}"));
  EXPECT_FALSE(check_port_pattern("(a)\\1"));
  EXPECT_FALSE(matches_port_pattern(".*", std::string(100'000, 'a')));
  EXPECT_FALSE(matches_port_pattern("(a+)+b", std::string(200, 'a')));
  EXPECT_FALSE(matches_port_pattern("(", "("));
}

TEST(PortPatternTest, RocksExpressionsAreSearchedForAnywhere) {
  EXPECT_EQ(whole_match_pattern(".*"), ".*");
  EXPECT_TRUE(matches_port_pattern(whole_match_pattern("^debug_ugv"), "debug_ugv_nav4d"));
  EXPECT_FALSE(matches_port_pattern(whole_match_pattern("^debug_ugv"), "x_debug_ugv"));
  EXPECT_TRUE(matches_port_pattern(whole_match_pattern("\\w"), "robot_frame"));
  EXPECT_TRUE(matches_port_pattern(whole_match_pattern("_in$"), "left_in"));
  EXPECT_FALSE(matches_port_pattern(whole_match_pattern("_in$"), "left_in_2"));
  EXPECT_TRUE(matches_port_pattern(whole_match_pattern("\\w+\\.\\w+"), "camera.frame"));
  EXPECT_TRUE(matches_port_pattern(whole_match_pattern("^a|b$"), "xb"));
}

TEST(InheritanceTest, ChildrenInheritFromTheirParents) {
  Diagnostics diagnostics;
  ComponentCatalog catalog;
  EXPECT_TRUE(read_components(R"(tasks:
  cam::Usb: {subclasses: Task, properties: [{name: device, type: /string, default: /dev/video0}]}
)",
                              "usb.yaml", catalog, diagnostics));
  EXPECT_TRUE(read_components(R"(tasks:
  cam::Task:
    abstract: true
    output_ports: [{name: frame, type: /Frame, wrapper: ro_ptr}]
    properties: [{name: device, type: /string}, {name: gain, type: /double, dynamic: true}]
    default_activity: {type: periodic, period: 0.01}
)",
                              "cam.yaml", catalog, diagnostics));
  resolve_inheritance(catalog, diagnostics);
  ASSERT_THAT(diagnostics.items(), IsEmpty()) << to_string(diagnostics);
  const ComponentModel* usb = catalog.find(ComponentName("cam::Usb"));
  EXPECT_FALSE(usb->abstract);
  EXPECT_EQ(usb->find_port("frame", Direction::Output)->type, "/Frame");
  EXPECT_EQ(usb->find_property("device")->default_value, Value("/dev/video0"));
  EXPECT_TRUE(usb->find_property("gain")->live);
  EXPECT_EQ(usb->activity.period, std::chrono::milliseconds(10));
  EXPECT_EQ(std::ranges::count(usb->properties, "device", &PropertyModel::name), 1);
  EXPECT_EQ(std::ranges::count(usb->ports, "state", &PortModel::name), 1);
}

TEST(InheritanceTest, AMissingParentIsAWarning) {
  Diagnostics diagnostics;
  ComponentCatalog catalog;
  read_components("tasks: {a::T: {subclasses: b::Gone}}", "a.yaml", catalog, diagnostics);
  resolve_inheritance(catalog, diagnostics);
  EXPECT_FALSE(diagnostics.has_errors());
  EXPECT_THAT(to_string(diagnostics), HasSubstr("unknown-parent"));
  EXPECT_TRUE(catalog.find(ComponentName("a::T"))->incomplete);
}

TEST(InheritanceTest, ACycleIsAnError) {
  Diagnostics diagnostics;
  ComponentCatalog catalog;
  read_components("tasks: {a::A: {subclasses: B}, a::B: {subclasses: C}, a::C: {subclasses: A}}", "a.yaml",
                  catalog, diagnostics);
  resolve_inheritance(catalog, diagnostics);
  EXPECT_EQ(diagnostics.error_count(), 1U) << to_string(diagnostics);
}

TEST(RockModelTest, ExportedModelsRead) {
  Diagnostics diagnostics;
  const ComponentCatalog catalog = read_all(R"(---
gps:
  Task:
    inputPorts: []
    outputPorts: [{Name: time, Type: "::gps::Time"}, {Name: state, Type: "boost::int32_t"}]
    dynamicInputPorts: [{Name: "/^raw_/", Type: "::std::string"}]
    properties:
    - {Name: utm_north, Type: bool, DefaultVal: 0}
    - {Name: mode, Type: "::gps::Mode", DefaultVal: ":FIX"}
    operations:
    - {Name: clear, Doc: , Return: {Type: void, Doc: ''}, Arguments: [{Name: a, Type: "::std::vector< ::gps::X >", Doc: d}]}
)",
                                            diagnostics);
  ASSERT_THAT(diagnostics.items(), IsEmpty()) << to_string(diagnostics);
  const ComponentModel* model = catalog.find(ComponentName("gps::Task"));
  ASSERT_NE(model, nullptr);
  EXPECT_EQ(model->find_port("time", Direction::Output)->type, "/gps/Time");
  EXPECT_EQ(model->find_port("raw_1", Direction::Input)->type, "/std/string");
  EXPECT_EQ(model->find_property("utm_north")->default_value, Value(false));
  EXPECT_EQ(model->find_property("mode")->default_value, Value("FIX"));
  EXPECT_EQ(model->operations.at(0).result, "");
  EXPECT_EQ(model->operations.at(0).arguments.at(0).type, "/std/vector</gps/X>");
}

TEST(RockModelTest, GuessesAndReferencesAreWarnings) {
  Diagnostics diagnostics;
  const ComponentCatalog catalog = read_all(R"(tasks:
  a::T: {input_ports: [{name: x, type: '?/base/Pose'}, {name: y, type: '?some thing'}], output_ports: []}
  b::T: {see: ../b.yml}
  c::T: {input_ports: [{name: z, type: "/std/vector</c/X"}]}
)",
                                            diagnostics);
  EXPECT_FALSE(diagnostics.has_errors()) << to_string(diagnostics);
  const ComponentModel* model = catalog.find(ComponentName("a::T"));
  ASSERT_NE(model, nullptr);
  EXPECT_TRUE(model->incomplete);
  EXPECT_EQ(model->find_port("x", Direction::Input)->type, "/base/Pose");
  EXPECT_EQ(model->find_port("y", Direction::Input)->type, "");
  EXPECT_EQ(catalog.find(ComponentName("b::T")), nullptr);
  EXPECT_EQ(catalog.find(ComponentName("c::T"))->find_port("z", Direction::Input)->type, "/std/vector</c/X>");
  EXPECT_THAT(to_string(diagnostics), HasSubstr("is read as '/std/vector</c/X>'"));
}

TEST(RockModelTest, TheTransformerAddsPortsAndProperties) {
  Diagnostics diagnostics;
  const ComponentCatalog catalog = read_all(R"(tasks:
  odometry::Skid:
    input_ports: []
    transformer:
      kind: transformer
      transformations: [{from: body, to: imu_world}]
      aligned_ports: [{port: samples, period: 0.01}]
      max_latency: 0.1
)",
                                            diagnostics);
  ASSERT_THAT(diagnostics.items(), IsEmpty()) << to_string(diagnostics);
  const ComponentModel* model = catalog.find(ComponentName("odometry::Skid"));
  EXPECT_NE(model->find_port("dynamic_transformations", Direction::Input), nullptr);
  EXPECT_NE(model->find_property("static_transformations"), nullptr);
  EXPECT_EQ(model->find_property("body_frame")->default_value, Value("body"));
  EXPECT_EQ(model->find_property("samples_period")->default_value, Value(0.01));
}

TEST(RealModelsSharedData, EveryInterfaceAndExportedModelReads) {
  if (const auto missing = missing_shared_data("rock"); !missing.empty()) GTEST_SKIP() << missing;
  ComponentCatalog catalog;
  Diagnostics diagnostics;
  std::set<fs::path> files;
  for (const char* folder : {"interfaces", "models"}) {
    for (const auto& entry : fs::directory_iterator(shared_data("rock") / folder))
      files.insert(entry.path());
  }
  for (const fs::path& file : files) {
    EXPECT_EQ(kind_of_file(file, *read_file(file)), FileKind::Components) << file;
    EXPECT_TRUE(load_components(file, catalog, diagnostics)) << to_string(diagnostics);
  }
  resolve_inheritance(catalog, diagnostics);
  EXPECT_FALSE(diagnostics.has_errors()) << to_string(diagnostics);
  std::set<std::string> codes;
  for (const Diagnostic& item : diagnostics.items())
    codes.insert(item.code);
  EXPECT_THAT(codes, ElementsAre("guessed-type", "reference", "unreadable-default", "unreadable-type"))
      << to_string(diagnostics);
  EXPECT_EQ(files.size(), 32U);
  EXPECT_EQ(catalog.size(), 76U);
  const ComponentModel* usb = catalog.find(ComponentName("camera_usb::Task"));
  ASSERT_NE(usb, nullptr);
  EXPECT_NE(usb->find_port("frame", Direction::Output), nullptr);
  expect_round_trip(catalog);
}

TEST(RealModelsSharedData, EveryTypelibRegistryReads) {
  if (const auto missing = missing_shared_data("rock/typelib"); !missing.empty()) GTEST_SKIP() << missing;
  for (const auto& entry : fs::directory_iterator(shared_data("rock/typelib"))) {
    ComponentCatalog catalog;
    Diagnostics diagnostics;
    EXPECT_TRUE(load_components(entry.path(), catalog, diagnostics)) << to_string(diagnostics);
    // A component that uses all types is written to our format and read again.
    ComponentModel user;
    user.name = ComponentName("demo::User");
    int number = 0;
    for (const type::Type* type : catalog.types().types())
      user.ports.push_back({"p" + std::to_string(number++), Direction::Input, type->name, false, false, ""});
    catalog.add(user);
    expect_round_trip(catalog);
  }
}

}  // namespace
}  // namespace segue::model
