// SPDX-License-Identifier: Apache-2.0
// Files of Rock beside networks: property files with their sections, networks that include others, and
// .orogen files.
#include <segue/model/files.hpp>
#include <segue/type/yaml.hpp>

#include <support/temporary_files.hpp>

#include <gmock/gmock.h>

namespace segue::model {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using type::Value;

class RockFiles : public ::testing::Test {
 protected:
  std::optional<Network> load(const std::string& file) {
    diagnostics_ = {};
    return load_network(files_.folder() / file, diagnostics_);
  }

  std::string first_problem() const {
    return diagnostics_.empty() ? "" : to_string(diagnostics_.items().front());
  }

  testing::TemporaryFiles files_;
  Diagnostics diagnostics_;
};

constexpr const char* kProperties = R"(--- name:default
speed: 1.0
mode: :SLOW
limits: {low: 1, high: 2}
--- name:outdoor
speed: 2.0
limits: {high: 5}
)";

TEST_F(RockFiles, SectionsAreLaidOverEachOtherAndUnderTheTasksOwnProperties) {
  files_.write("bundle/config/orogen/drive::Task.yml", kProperties);
  files_.write(
      "bundle/networks/go.cnd",
      "tasks:\n  a: {type: drive::Task, config_names: [default, outdoor], config: {limits: {low: 0}}}\n");
  const auto network = load("bundle/networks/go.cnd");
  ASSERT_TRUE(network && diagnostics_.empty()) << to_string(diagnostics_);
  EXPECT_EQ(type::to_yaml(network->tasks[0].properties),
            "speed: 2.0\nmode: SLOW\nlimits: {low: 0, high: 5}\n");
  EXPECT_THAT(network->tasks[0].config_names, IsEmpty());
}

TEST_F(RockFiles, TheVersionOfANetworkIsThatOfAllItsFiles) {
  files_.write("config/drive::Task.yml", kProperties);
  files_.write("go.cnd", "tasks:\n  a: {type: drive::Task, config_names: [default]}\n");
  const std::string before = load("go.cnd")->version;
  files_.write("config/drive::Task.yml", "speed: 3.0\n");
  EXPECT_NE(load("go.cnd")->version, before);
}

TEST_F(RockFiles, ASectionThatIsNotThereIsAnErrorWithASuggestion) {
  files_.write("config/drive::Task.yml", kProperties);
  files_.write("go.cnd", "tasks:\n  a: {type: drive::Task, config_names: [outdor]}\n");
  EXPECT_FALSE(load("go.cnd"));
  EXPECT_THAT(first_problem(), HasSubstr("has no section 'outdor', did you mean 'outdoor'?"));
}

TEST_F(RockFiles, ErrorsInAPropertyFileHaveTheirLine) {
  files_.write("go.cnd", "tasks:\n  a: {type: drive::Task, config_names: [x]}\n");
  for (const auto& [text, problem] :
       {std::pair("--- name:default\na: 1\n--- name:x\nb: [1\n", "begins at line 4"),
        std::pair("a: 1\n--- name:x\nb: <%= 1 %>\n", "this is a template"),
        std::pair("--- name:x\n- 1\n", "must be a map of properties, got a list of 1")}) {
    files_.write("config/drive::Task.yml", text);
    EXPECT_FALSE(load("go.cnd"));
    EXPECT_THAT(first_problem(), HasSubstr(problem));
  }
}

TEST_F(RockFiles, ANetworkHasWhatItIncludesAndItsOwnInPlaceOfIt) {
  files_.write("base.yaml", R"(network: base
tasks:
  a: {component: x::A, properties: {rate: 1}}
  b: {component: x::B}
connections: [a.out -> b.in]
)");
  files_.write("more/go.yaml", R"(network: go
include: ../base.yaml
tasks:
  a: {component: x::A, properties: {rate: 2}}
  c: {component: x::C}
connections:
  - {from: a.out, to: b.in, policy: buffer, size: 5}
  - b.out -> c.in
)");
  const auto network = load("more/go.yaml");
  ASSERT_TRUE(network) << to_string(diagnostics_);
  EXPECT_EQ(network->name, NetworkName("go"));
  ASSERT_THAT(network->tasks, SizeIs(3));
  EXPECT_EQ(network->tasks[0].properties, Value::map({{"rate", 2}}));
  ASSERT_THAT(network->connections, SizeIs(2));
  EXPECT_EQ(network->connections[0].policy.size, 5U);
}

TEST_F(RockFiles, FilesThatIncludeEachOtherAreAnError) {
  files_.write("a.cnd", "include: b.cnd\ntasks: {}\n");
  files_.write("b.cnd", "include: [a.cnd]\ntasks: {}\n");
  EXPECT_FALSE(load("a.cnd"));
  EXPECT_THAT(first_problem(), HasSubstr("'a.cnd' includes this file, which includes it"));
  files_.write("b.cnd", "include: [gone.cnd]\ntasks: {}\n");
  EXPECT_FALSE(load("a.cnd"));
  EXPECT_THAT(first_problem(), HasSubstr("b.cnd:1:10: error: cannot read"));
}

TEST_F(RockFiles, FilesThatAreIncludedInVeryManyWaysAreAnError) {
  for (int i = 0; i < 11; ++i) {
    const std::string next = std::to_string(i + 1) + ".cnd";
    files_.write(std::to_string(i) + ".cnd", "include: [" + next + ", " + next + "]\ntasks: {}\n");
  }
  files_.write("11.cnd", "tasks: {}\n");
  EXPECT_FALSE(load("0.cnd"));
  EXPECT_THAT(first_problem(), HasSubstr("more than 1000 files"));
}

struct Models {
  ComponentCatalog catalog;
  Diagnostics diagnostics;
};

Models orogen(std::string_view text) {
  Models models;
  (void)read_components(text, "drive.orogen", models.catalog, models.diagnostics);
  return models;
}

constexpr std::string_view kOrogen = R"(
# A driver
name "drive"
version "0.1"
import_types_from "base"
using_task_library 'iodrivers_base'

=begin
task_context "Hidden" do
=end
task_context "Base", subclasses: "RTT::TaskContext" do
  abstract
  property("speed", "double", 0.5).
      doc("metres per second, e.g. \"0.5\"").
      dynamic
  property "mode", "/drive/Mode", :SLOW
  property('computed', 'double', 2 * 3)
end

task_context "Task" do
  needs_configuration
  subclasses "Base"
  doc "Drives" \
      " the rover"
  input_port("command", "/base/commands/Motion2D").needs_reliable_connection
  output_port "pose", ro_ptr("/base/Pose")
  output_port("status", "/drive/Status")
    .doc "how it goes"
  dynamic_input_port(/^sensor_\w+$/, "/base/Pose")
  operation("stop").
    returns("bool").
    argument("gently", "/bool", "with a ramp").
    runs_in_caller_thread
  runtime_states :SLIPPING, :BLOCKED
  error_states :BROKEN
  port_driven ["command"]
  transformer do
    transform "body", "world"
    align_port "command", 0.1
    max_latency 0.5
  end
  %w{a b}.each do |side|
    input_port("wheel_#{side}", "double")
  end
end

deployment "drives" do
  task("drive", "Task").periodic(0.1)
end
)";

TEST(Orogen, DeclarationsBecomeComponentModels) {
  const Models models = orogen(kOrogen);
  const ComponentModel* base = models.catalog.find(ComponentName("drive::Base"));
  ASSERT_NE(base, nullptr) << to_string(models.diagnostics);
  EXPECT_TRUE(base->abstract && base->parent.empty());
  EXPECT_EQ(base->find_property("speed")->default_value, Value(0.5));
  EXPECT_TRUE(base->find_property("speed")->live);
  EXPECT_EQ(base->find_property("speed")->doc, "metres per second, e.g. \"0.5\"");
  EXPECT_EQ(base->find_property("mode")->default_value, Value("SLOW"));

  const ComponentModel* task = models.catalog.find(ComponentName("drive::Task"));
  ASSERT_NE(task, nullptr);
  EXPECT_EQ(task->parent, "drive::Base");
  EXPECT_EQ(task->doc, "Drives the rover");
  ASSERT_NE(task->find_port("command", Direction::Input), nullptr);
  EXPECT_EQ(task->find_port("status", Direction::Output)->doc, "how it goes");
  EXPECT_NE(task->find_port("sensor_left", Direction::Input), nullptr);
  ASSERT_THAT(task->operations, SizeIs(1));
  EXPECT_EQ(task->operations[0].result, "/bool");
  EXPECT_TRUE(task->operations[0].caller_thread);
  EXPECT_EQ(task->operations[0].arguments[0].doc, "with a ramp");
  EXPECT_THAT(task->nominal_states, ElementsAre("SLIPPING", "BLOCKED"));
  EXPECT_THAT(task->error_states, ElementsAre("BROKEN"));
  EXPECT_EQ(task->activity.trigger, Trigger::PortDriven);
  EXPECT_THAT(task->trigger_ports, ElementsAre("command"));
  EXPECT_NE(task->find_property("command_period"), nullptr);
  EXPECT_NE(task->find_port("dynamic_transformations", Direction::Input), nullptr);
  EXPECT_EQ(models.catalog.size(), 2U) << "neither what is in comments, nor deployments";
}

TEST(Orogen, CodeThatIsNotEvaluatedIsNamedByItsLine) {
  std::vector<int> lines;
  const Models models = orogen(kOrogen);
  for (const Diagnostic& item : models.diagnostics.items()) {
    EXPECT_EQ(item.code, "not-evaluated") << to_string(item);
    lines.push_back(item.where.line);
  }
  EXPECT_THAT(lines, ElementsAre(17, 42)) << to_string(models.diagnostics);
}

TEST(Orogen, WhatIsNotClosedOrNoTextIsAnError) {
  for (const auto& [text, problem] :
       {std::pair("name \"drive\ntask", "line 1: a text is not closed"),
        std::pair("name(\"drive\"\n", "a bracket is not closed"),
        std::pair("name 'drive'\ntask_context 'A' do\n", "a block has no 'end'"),
        std::pair("name 'drive'\nend\n", "an 'end' has no block"),
        std::pair("name 'dr\xff'\n", "is not valid UTF-8")}) {
    const Models models = orogen(text);
    EXPECT_THAT(to_string(models.diagnostics), HasSubstr(problem));
    EXPECT_TRUE(models.diagnostics.has_errors());
  }
}

}  // namespace
}  // namespace segue::model
