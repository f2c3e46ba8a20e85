// SPDX-License-Identifier: Apache-2.0
//
// Tasks request controllers of a runtime.
#include <segue/runtime/served_runtime.hpp>
#include <segue/runtime/test_support.hpp>
#include <segue/task/component.hpp>

#include <support/eventually.hpp>

#include <gmock/gmock.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

namespace task_requests_test {

using namespace std::chrono_literals;

/// Writes what it wishes again and again.
struct Handler : segue::task::Component {
  Handler() : Component({.activity = segue::periodic(1ms)}) {}
  void on_update() override { request.write(*wish); }
  segue::task::OutputPort<std::string> request{*this, "request"};
  segue::task::Property<std::string> wish{*this, "wish", "", {.live = true}};
};

}  // namespace task_requests_test

SEGUE_COMPONENT(task_requests_test::Handler)

namespace task_requests_test {
namespace {

using segue::model::NetworkName;
using segue::runtime::Event;
using segue::runtime::EventKind;
using segue::testing::eventually;
using segue::testing::network_of;
using ::testing::HasSubstr;

constexpr const char* kHandler =
    "tasks: {handler: {component: 'task_requests_test::Handler'}, runtime: {component: "
    "'runtime::Requests'}}\n"
    "connections: [handler.request -> runtime.request]\n";

class TaskRequests : public ::testing::Test {
 protected:
  TaskRequests() { begin(); }

  void begin() {
    runtime_ = std::make_unique<segue::runtime::Runtime>("robot", host_, catalog_);
    EXPECT_FALSE(
        runtime_->add_controller(network_of(std::string("network: explore\n") + kHandler)).has_errors());
    for (const char* name : {"go", "come"}) {
      auto network = network_of("tasks: {a: {component: x::A}}\n");
      network.name = NetworkName(name);
      EXPECT_FALSE(runtime_->add_controller(std::move(network)).has_errors());
    }
  }
  void explore() { ASSERT_TRUE(runtime_->switch_to(NetworkName("explore"), {.who = "ann"}).ok()); }
  void wish(const std::string& controller) {
    const auto set = host_.set_property(segue::model::TaskId("handler"), "wish", controller,
                                        segue::RealClock::instance().now() + 30s);
    ASSERT_TRUE(set) << to_string(set.error());
  }
  [[nodiscard]] std::string runs() const { return runtime_->belief().name.str(); }
  /// Waits for a refusal, and says why.
  std::string refusal() {
    std::uint64_t last = 0;
    std::vector<Event> events;
    while (!(events = runtime_->events(last, 60s)).empty()) {
      for (const Event& event : events) {
        last = event.number;
        if (event.kind == EventKind::RequestRefused) return event.message;
      }
    }
    return "nothing was refused";
  }
  /// Whether something was requested of `runtime`, whoever has looked at it.
  bool has_requests() {
    const auto answer = host_.call(segue::model::TaskId("runtime"), "requests", segue::type::Value::list({0}),
                                   segue::RealClock::instance().now() + 30s);
    return answer && !answer->find("controllers")->as_list().empty();
  }

  segue::model::ComponentCatalog catalog_;
  segue::task_host::LibrarySet libraries_;
  segue::task_host::LocalTaskHost host_{
      libraries_, catalog_, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  std::unique_ptr<segue::runtime::Runtime> runtime_;
};

TEST_F(TaskRequests, AreCarriedOutOnceWithTheTaskAsTheirOrigin) {
  explore();
  wish("go");
  ASSERT_TRUE(eventually([&] { return runtime_->history().size() > 1; }));
  EXPECT_EQ(runs(), "go");
  EXPECT_EQ(runtime_->history().size(), 2U) << "what is written again and again is one request";
  EXPECT_EQ(runtime_->history().back().who, "task handler");
}

TEST_F(TaskRequests, ThatAreRefusedAreEvents) {
  explore();
  wish("nowhere");
  EXPECT_THAT(refusal(), HasSubstr("no controller 'nowhere'"));
  EXPECT_EQ(runs(), "explore");
}

TEST_F(TaskRequests, DoNotEndAHalt) {
  explore();
  runtime_->halt({.who = "ann"}).wait();
  wish("go");
  EXPECT_THAT(refusal(), HasSubstr("the robot was halted by ann, and requests of tasks do not end that"));
  ASSERT_TRUE(runtime_->halted());
  explore();
  wish("come");
  EXPECT_TRUE(eventually([&] { return runs() == "come"; })) << "somebody has commanded the robot since";
}

TEST_F(TaskRequests, AreRefusedWhileAMissionCommandsTheRobot) {
  explore();
  ASSERT_TRUE(runtime_->served().take_lease("mission patrol"));
  wish("go");
  EXPECT_THAT(refusal(), HasSubstr("mission patrol"));
  EXPECT_EQ(runs(), "explore");
}

TEST_F(TaskRequests, OfBeforeTheRuntimeBeganAreTooLate) {
  explore();
  runtime_.reset();
  wish("go");
  ASSERT_TRUE(eventually([&] { return has_requests(); }));
  begin();
  EXPECT_THAT(refusal(), HasSubstr("task handler requested it before this runtime began"));
  wish("come");
  EXPECT_TRUE(eventually([&] { return runs() == "come"; })) << "what is requested now is carried out";
}

}  // namespace
}  // namespace task_requests_test
