// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/test_support.hpp>

#include <segue/type/yaml.hpp>

#include <support/shared_data.hpp>

#include <gmock/gmock.h>

#include <vector>

namespace segue::task_host {
namespace {

namespace fs = std::filesystem;
using model::ActionKind;
using ::testing::HasSubstr;

/// Configure, start, stop and clean up a stand-in for each component of the catalog.
void live_through(const model::ComponentCatalog& catalog, int& count) {
  const LibrarySet libraries;
  LocalOptions options;
  options.only_stand_ins = true;
  LocalTaskHost host(libraries, catalog, options);
  for (const auto* model : catalog.all()) {
    const auto definition = testing::task_of("task", model->name.str());
    for (const auto& action :
         {testing::apply(definition), testing::on_task(ActionKind::Configure, "task"),
          testing::on_task(ActionKind::Start, "task"), testing::on_task(ActionKind::Stop, "task"),
          testing::on_task(ActionKind::Cleanup, "task")}) {
      const auto done = host.perform(action, testing::soon());
      ASSERT_TRUE(done) << model->name.str() << ": " << to_string(done.error());
    }
    const auto seen = host.describe(model::TaskId("task"));
    ASSERT_TRUE(seen);
    for (const auto& port : model->ports) {
      if (!port.dynamic && !port.pattern) {
        EXPECT_NE(seen->find_port(port.name, port.direction), nullptr)
            << model->name.str() << " " << port.name;
      }
    }
    ++count;
  }
}

TEST(StandInSharedData, EveryRockComponentLivesThroughItsLifeCycle) {
  if (const auto missing = missing_shared_data("rock"); !missing.empty()) GTEST_SKIP() << missing;
  int count = 0;
  for (const char* folder : {"interfaces", "models"}) {
    for (const auto& file : fs::directory_iterator(shared_data("rock") / folder)) {
      model::ComponentCatalog catalog;
      Diagnostics diagnostics;
      model::load_components(file.path(), catalog, diagnostics);
      model::resolve_inheritance(catalog, diagnostics);  // parents may stand in another file
      live_through(catalog, count);
    }
  }
  EXPECT_GT(count, 60);
}

TEST(StandIn, BehaviourIsReadAndHostileValuesAreRefused) {
  const auto read = [](const char* text) {
    return read_behaviour(type::parse_yaml(text).value_or(type::Value()), {}, "stand_in");
  };
  const auto good = read("{configure: 30ms, stop: 1.3s, rate: 20, fail: [start, connect], hang: update}");
  ASSERT_TRUE(good);
  EXPECT_EQ(good->configure, std::chrono::milliseconds(30));
  EXPECT_EQ(good->stop, std::chrono::milliseconds(1300));
  EXPECT_EQ(good->rate, 20.0);
  EXPECT_TRUE(good->fails("connect"));
  EXPECT_FALSE(good->fails("stop"));
  EXPECT_TRUE(good->hangs("update"));
  EXPECT_FALSE(good->hangs("stop"));
  for (const char* bad : {"3", "[a]", "{configure: 30}", "{configure: -1s}", "{configure: 99999h}",
                          "{rate: .nan}", "{rate: -1}", "{rate: 1e9}", "{rate: far}", "{fail: everything}",
                          "{fail: [[start]]}", "{hang: connect}", "{fial: start}", "{stop: {}}"}) {
    const auto refused = read(bad);
    ASSERT_FALSE(refused) << bad;
    EXPECT_THAT(refused.error().message, HasSubstr("stand_in")) << bad;
  }
  EXPECT_THAT(read("{fial: start}").error().message, HasSubstr("did you mean 'fail'"));
}

TEST(StandIn, TheTaskWinsOverTheComponentAndThatOverTheDefault) {
  Diagnostics diagnostics;
  const auto document = type::parse_yaml(
      "stand_ins: {default: {configure: 1ms, start: 1ms, stop: 1ms}, a::A: {start: 2ms, stop: 2ms}, a: "
      "{stop: 3ms}}");
  const auto table = StandInTable::read(*document, "x.yaml", diagnostics);
  ASSERT_TRUE(table) << to_string(diagnostics);
  const auto behaviour = table->of(model::ComponentName("a::A"), model::TaskId("a"));
  EXPECT_EQ(behaviour.configure, std::chrono::milliseconds(1));
  EXPECT_EQ(behaviour.start, std::chrono::milliseconds(2));
  EXPECT_EQ(behaviour.stop, std::chrono::milliseconds(3));
}

TEST(StandIn, AFileReportsAllItsProblems) {
  Diagnostics diagnostics;
  const auto document = type::parse_yaml("stand_ins:\n  a: {rate: x}\n  b: {stop: 3}\n");
  EXPECT_FALSE(StandInTable::read(*document, "x.yaml", diagnostics));
  EXPECT_EQ(diagnostics.error_count(), 2U);
  EXPECT_EQ(diagnostics.items().at(0).where.line, 2);
}

/// A task of a component with a family of ports and an operation.
class ModelledStandIn : public ::testing::Test {
 protected:
  ModelledStandIn() {
    Diagnostics diagnostics;
    EXPECT_TRUE(model::read_components(R"(
components:
  demo::Mux:
    ports:
      - {pattern: "in_.*", direction: input, type: /double}
      - {name: out, direction: output, type: /double}
    properties:
      - {name: gain, type: /double, default: 2.0}
      - {name: mode, type: /std/string, default: fast, live: true}
    operations:
      - {name: count, arguments: [{name: from, type: /int32_t}], result: /int32_t}
)",
                                       "mux.yaml", catalog_, diagnostics))
        << to_string(diagnostics);
  }

  model::ComponentCatalog catalog_;
  LibrarySet libraries_;
  LocalTaskHost host_{libraries_, catalog_, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
};

TEST_F(ModelledStandIn, MakesThePortsOfAFamilyWhenItIsConfigured) {
  model::Network network;
  network.connections.push_back(testing::wire("mux", "out", "mux", "in_left"));
  host_.expect(network);
  ASSERT_TRUE(host_.perform(testing::apply(testing::task_of("mux", "demo::Mux")), testing::soon()));
  const auto loop = testing::on_connection(ActionKind::Connect, network.connections.front());
  const auto early = host_.perform(loop, testing::soon());
  ASSERT_FALSE(early);
  EXPECT_THAT(early.error().message, HasSubstr("dynamic"));
  ASSERT_TRUE(host_.perform(testing::on_task(ActionKind::Configure, "mux"), testing::soon()));
  EXPECT_NE(host_.describe(model::TaskId("mux"))->find_port("in_left", model::Direction::Input), nullptr);
  ASSERT_TRUE(host_.perform(loop, testing::soon()));
  EXPECT_EQ(host_.connections().size(), 1U);
  ASSERT_TRUE(host_.perform(testing::on_task(ActionKind::Cleanup, "mux"), testing::soon()));
  EXPECT_TRUE(host_.connections().empty()) << "the port is gone, and its connection with it";
}

TEST_F(ModelledStandIn, RefusesAPortThatItsModelLacks) {
  ASSERT_TRUE(host_.perform(testing::apply(testing::task_of("mux", "demo::Mux")), testing::soon()));
  const auto wrong = testing::wire("mux", "output", "mux", "in_left");
  const auto done = host_.perform(testing::on_connection(ActionKind::Connect, wrong), testing::soon());
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::NotFound);
}

TEST_F(ModelledStandIn, HasPropertiesAndOperationsOfItsModel) {
  const auto wrong = testing::task_of("mux", "demo::Mux", type::Value::map({{"gain", "far"}}));
  const auto refused = host_.perform(testing::apply(wrong), testing::soon());
  ASSERT_FALSE(refused);
  EXPECT_THAT(to_string(refused.error()), HasSubstr("gain"));
  const auto good =
      testing::task_of("mux", "demo::Mux", type::Value::map({{"gain", 3.0}, {"colour", "red"}}));
  ASSERT_TRUE(host_.perform(testing::apply(good), testing::soon()));
  const auto properties = host_.properties(model::TaskId("mux"));
  ASSERT_TRUE(properties);
  EXPECT_EQ(*properties->find("gain"), type::Value(3.0));
  EXPECT_EQ(*properties->find("mode"), type::Value("fast"));
  EXPECT_EQ(*properties->find("colour"), type::Value("red")) << "what the model lacks is kept";
  const auto answer =
      host_.call(model::TaskId("mux"), "count", type::Value::map({{"from", 1}}), testing::soon());
  ASSERT_TRUE(answer) << to_string(answer.error());
  EXPECT_EQ(*answer, type::Value(0));
}

}  // namespace
}  // namespace segue::task_host
