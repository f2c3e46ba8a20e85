// SPDX-License-Identifier: Apache-2.0
#include <segue/base/virtual_clock.hpp>
#include <segue/task/component.hpp>
#include <segue/task/probe_component.hpp>
#include <segue/task/realtime_log.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <thread>

using namespace std::chrono_literals;

namespace demo {

class Filter : public segue::task::Component {
 public:
  Filter()
      : Component({.doc = "a filter",
                   .activity = segue::periodic(10ms),
                   .claims = {"/dev/x"},
                   .trigger_on = {"input"}}) {}

  std::unique_ptr<segue::task::InputPort<int>> extra;

 protected:
  segue::Result<void> on_configure() override {
    extra = std::make_unique<segue::task::InputPort<int>>(
        *this, "extra", segue::task::PortOptions{.dynamic = true, .doc = "", .keep_last = true});
    return {};
  }
  void on_cleanup() override { extra.reset(); }

 private:
  segue::task::State settling_{*this, "SETTLING"};
  segue::task::ErrorState sensor_lost_{*this, "SENSOR_LOST"};
  segue::task::InputPort<double> input_{*this, "input"};
  segue::task::OutputPort<double> output_{*this, "output"};
};

class Unmakeable : public segue::task::Component {
 public:
  Unmakeable() { throw std::runtime_error("no licence"); }
};

}  // namespace demo

SEGUE_COMPONENT(demo::Filter)
SEGUE_COMPONENT(demo::Unmakeable)

namespace segue::task {
namespace {

using test::soon;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ComponentRegistry, MakesWhatThisProgramRegistered) {
  auto entry = find_component("demo::Filter");
  ASSERT_TRUE(entry);
  EXPECT_EQ(entry->library, "");
  EXPECT_EQ(entry->abi, kComponentAbi);
  auto made = entry->create();
  ASSERT_TRUE(made);
  EXPECT_EQ((*made)->component_name(), "demo::Filter");
  EXPECT_FALSE(find_component("demo::Filtre"));
}

TEST(ComponentRegistry, ConstructorThatThrowsIsAnError) {
  auto made = find_component("demo::Unmakeable")->create();
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message, HasSubstr("no licence"));
}

TEST(ComponentRegistry, RemembersTheLibraryThatIsBeingLoaded) {
  const auto make = +[]() -> std::unique_ptr<Component> { return std::make_unique<demo::Filter>(); };
  {
    const LibraryScope loading("demo_library");
    const detail::Registration registration("::demo::FromLibrary", kComponentAbi, make);
  }
  ASSERT_TRUE(find_component("demo::FromLibrary"));
  EXPECT_EQ(find_component("demo::FromLibrary")->library, "demo_library");
}

TEST(ComponentRegistry, SecondOfANameIsRejectedAndReported) {
  static_cast<void>(take_rejected_components());
  const auto make = +[]() -> std::unique_ptr<Component> { return nullptr; };
  EXPECT_FALSE(register_component({"demo::Filter", "impostor", std::string(kComponentAbi), make}));
  EXPECT_EQ(find_component("demo::Filter")->library, "");
  const auto rejected = take_rejected_components();
  ASSERT_EQ(rejected.size(), 1U);
  EXPECT_EQ(rejected[0].library, "impostor");
  EXPECT_TRUE(take_rejected_components().empty());
}

TEST(ComponentRegistry, AnotherAbiIsRefused) {
  ComponentEntry entry = *find_component("demo::Filter");
  entry.abi = "segue-0.0/1";
  auto made = entry.create();
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message, HasSubstr("compile its library anew"));
}

TEST(ComponentInterface, IsReadableWithoutATask) {
  const demo::Filter filter;
  ASSERT_EQ(filter.inputs().size(), 1U);
  EXPECT_EQ(filter.inputs()[0]->name(), "input");
  EXPECT_EQ(filter.inputs()[0]->type_name(), "/double");
  std::vector<std::string> outputs;
  for (const OutputPortBase* output : filter.outputs())
    outputs.push_back(output->name());
  EXPECT_THAT(outputs, ElementsAre("state", "output"));
  EXPECT_THAT(filter.nominal_states(), ElementsAre("SETTLING"));
  EXPECT_THAT(filter.error_states(), ElementsAre("SENSOR_LOST"));
  EXPECT_THAT(filter.options().claims, ElementsAre("/dev/x"));
  EXPECT_THAT(filter.options().trigger_on, ElementsAre("input"));
  EXPECT_EQ(filter.options().activity, periodic(10ms));
  EXPECT_EQ(filter.options().doc, "a filter");
  EXPECT_EQ(filter.find_output("input"), nullptr);
}

TEST(ComponentInterface, DynamicPortsComeWithConfigureAndGoWithCleanup) {
  VirtualClock clock;
  auto made = Task::create("filter", std::make_unique<demo::Filter>(), Activity{},
                           std::make_shared<ManualExecutor>(clock));
  ASSERT_TRUE(made);
  Component& filter = (*made)->component();
  EXPECT_EQ(filter.find_input("extra"), nullptr);
  ASSERT_TRUE((*made)->configure(soon()));
  ASSERT_NE(filter.find_input("extra"), nullptr);
  EXPECT_TRUE(filter.find_input("extra")->dynamic());
  EXPECT_EQ(filter.find_input("extra")->full_name(), "filter.extra");
  ASSERT_TRUE((*made)->cleanup(soon()));
  EXPECT_EQ(filter.find_input("extra"), nullptr);
}

class Log : public ::testing::Test {
 protected:
  Log() {
    set_log_sink([this](LogLevel, std::string_view source, std::string_view message) {
      lines.push_back(std::string(source) + ": " + std::string(message));
    });
  }
  ~Log() override { set_log_sink({}); }
  std::vector<std::string> lines;
};

TEST_F(Log, PassesLinesOnInOrderAndCutsLongOnes) {
  RealtimeLog ring;
  EXPECT_TRUE(ring.push(LogLevel::Info, "task", "one"));
  EXPECT_TRUE(ring.push(LogLevel::Error, "task", std::string(1000, 'x')));
  EXPECT_EQ(ring.drain(), 2U);
  EXPECT_THAT(lines, ElementsAre("task: one", "task: " + std::string(RealtimeLog::kMessageBytes, 'x')));
}

TEST_F(Log, FullRingCountsWhatItLoses) {
  RealtimeLog ring;
  for (std::size_t i = 0; i < RealtimeLog::kLines; ++i)
    ASSERT_TRUE(ring.push(LogLevel::Info, "t", "m"));
  EXPECT_FALSE(ring.push(LogLevel::Info, "t", "too many"));
  EXPECT_EQ(ring.lost(), 1U);
  EXPECT_EQ(ring.drain(), RealtimeLog::kLines);
  EXPECT_THAT(lines.back(), HasSubstr("1 lines of tasks were lost"));
  EXPECT_TRUE(ring.push(LogLevel::Info, "t", "again"));
  EXPECT_EQ(ring.drain(), 1U);
}

TEST_F(Log, ManyThreadsLoseNothingThatFits) {
  RealtimeLog ring;
  std::vector<std::thread> writers;
  for (int i = 0; i < 4; ++i) {
    writers.emplace_back([&] {
      for (int j = 0; j < 5000; ++j) {
        while (!ring.push(LogLevel::Info, "t", "m"))
          ring.drain();
      }
    });
  }
  for (std::thread& writer : writers)
    writer.join();
  ring.drain();
  const auto is_line = [](const std::string& line) { return line == "t: m"; };
  EXPECT_EQ(std::ranges::count_if(lines, is_line), 20000);
}

}  // namespace
}  // namespace segue::task
