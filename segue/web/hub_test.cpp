// SPDX-License-Identifier: Apache-2.0
#include <segue/web/test_support.hpp>

namespace segue::web {
namespace {

using type::Value;

/// Counts what it is told.
class Looker final : public Viewer {
 public:
  void on_change(const std::string&) override { ++told; }
  std::atomic<int> told{0};
};

class HubTest : public WebTest {
 protected:
  HubTest() : link_([this] { return connection()(); }, std::chrono::milliseconds(5)) {}

  [[nodiscard]] bool becomes(const Hub& hub, const std::string& document, const Value& value) const {
    return eventually([&] {
      const auto newest = hub.newest(document);
      return newest && newest->error.empty() && newest->value == value;
    });
  }

  RobotLink link_;
  const Hub::Periods often_{.snapshots = std::chrono::milliseconds(20),
                            .ports = std::chrono::milliseconds(20)};
  const std::shared_ptr<Looker> viewer_ = std::make_shared<Looker>();
};

TEST_F(HubTest, NobodyLookingCostsTheRobotNothing) {
  Hub hub(link_, often_);
  ASSERT_TRUE(hub.subscribe(viewer_, "status"));
  ASSERT_TRUE(hub.subscribe(viewer_, "events"));
  ASSERT_TRUE(hub.subscribe(viewer_, "port/t/out"));
  ASSERT_TRUE(becomes(hub, "status", Value::map({{"robot", "fake"}})));
  ASSERT_TRUE(eventually([&] { return hub.newest("port/t/out") != nullptr && robot_.open_streams == 1; }));
  hub.leave(*viewer_);
  EXPECT_EQ(hub.newest("status"), nullptr);
  ASSERT_TRUE(eventually([&] { return robot_.open_streams == 0; })) << "the port is closed";
  // A question that was under way may still arrive; then there are no more, while another hub goes on asking.
  RobotLink other_link([this] { return connection()(); }, std::chrono::milliseconds(5));
  Hub other(other_link, often_);
  ASSERT_TRUE(other.subscribe(viewer_, "task/t"));
  const auto wait_for_periods = [&](int count) {
    const int asked = robot_.task_questions;
    return eventually([&] { return robot_.task_questions >= asked + count; });
  };
  EXPECT_TRUE(eventually([&] {
    const int before = robot_.questions - robot_.task_questions;
    return wait_for_periods(10) && robot_.questions - robot_.task_questions == before;
  }));
}

TEST_F(HubTest, UnitsAreADocumentByTheirNames) {
  Hub hub(link_, often_);
  ASSERT_TRUE(hub.subscribe(viewer_, "units"));
  const Value screws = Value::map({{"name", "screws"}, {"count", 40}});
  EXPECT_TRUE(becomes(hub, "units", Value::map({{"units", Value::map({{"screws", screws}})}})));
}

TEST_F(HubTest, AChangeIsAVersionAndNothingElseIs) {
  Hub hub(link_, often_);
  robot_.show(Value::map({{"tasks", Value::list({Value::map({{"id", "a"}, {"n", 1}})})}}));
  ASSERT_TRUE(hub.subscribe(viewer_, "status"));
  ASSERT_TRUE(becomes(hub, "status",
                      Value::map({{"tasks", Value::map({{"a", Value::map({{"id", "a"}, {"n", 1}})}})}})));
  const int asked = robot_.questions;
  ASSERT_TRUE(eventually([&] { return robot_.questions > asked + 3; }));
  EXPECT_EQ(hub.newest("status")->version, 1U);
  EXPECT_EQ(viewer_->told, 1);
  robot_.show(Value::map({{"tasks", Value::list({Value::map({{"id", "a"}, {"n", 2}})})}}));
  ASSERT_TRUE(eventually([&] { return hub.newest("status")->version == 2; }));
  EXPECT_EQ(hub.newest("status")->change, R"({"in":{"tasks":{"in":{"a":{"set":{"n":2}}}}}})");
}

TEST_F(HubTest, ALostRobotIsSaidAndFoundAgain) {
  Hub hub(link_, often_);
  ASSERT_TRUE(hub.subscribe(viewer_, "status"));
  ASSERT_TRUE(becomes(hub, "status", Value::map({{"robot", "fake"}})));
  serving_.reset();
  ASSERT_TRUE(eventually([&] { return !hub.newest("status")->error.empty(); }));
  EXPECT_EQ(hub.newest("status")->value, Value::map({{"robot", "fake"}})) << "what was known last stays";
  serve();
  EXPECT_TRUE(becomes(hub, "status", Value::map({{"robot", "fake"}})));
}

TEST_F(HubTest, LargeSamplesAreReadLessOftenAndThatIsSaid) {
  // A sample of the fake robot is one number: at a thousandth of a number a second it is large.
  Hub hub(link_, {.snapshots = often_.snapshots, .ports = often_.ports, .scalars_per_second = 1e-3});
  ASSERT_TRUE(hub.subscribe(viewer_, "port/t/out"));
  const auto has_sample = [&] {
    const auto newest = hub.newest("port/t/out");
    return newest && newest->value.is_map();
  };
  ASSERT_TRUE(eventually(has_sample));
  EXPECT_DOUBLE_EQ(hub.newest("port/t/out")->value.find("period_s")->as_double(), 1000.0);

  Hub quick(link_, often_);
  ASSERT_TRUE(quick.subscribe(viewer_, "port/t/out"));
  EXPECT_TRUE(eventually([&] {
    const auto newest = quick.newest("port/t/out");
    return newest && newest->version > 10;
  }));
  EXPECT_DOUBLE_EQ(quick.newest("port/t/out")->value.find("period_s")->as_double(), 0.02);
  EXPECT_EQ(hub.newest("port/t/out")->version, 1U) << "the next one is due in 1000 s";
}

TEST_F(HubTest, ASilentPortIsOpenedAgain) {
  Hub hub(link_, {.snapshots = often_.snapshots, .ports = often_.ports, .silence = often_.ports});
  robot_.is_silent = true;
  ASSERT_TRUE(hub.subscribe(viewer_, "port/t/out"));
  ASSERT_TRUE(eventually([&] { return robot_.opened > 2; }));
  robot_.is_gone = true;
  ASSERT_TRUE(eventually([&] {
    const auto newest = hub.newest("port/t/out");
    return newest && newest->error.find("no such task") != std::string::npos;
  })) << "that its task has gone is said";
  robot_.is_silent = false;
  robot_.is_gone = false;
  EXPECT_TRUE(eventually([&] {
    const auto newest = hub.newest("port/t/out");
    return newest && newest->error.empty() && newest->value.is_map();
  })) << "its successor is heard";
}

TEST_F(HubTest, EventsAreKeptInOrder) {
  Hub hub(link_, often_);
  ASSERT_TRUE(hub.subscribe(viewer_, "events"));
  ASSERT_TRUE(eventually([&] {
    const auto newest = hub.newest("events");
    return newest && newest->value.is_map() && newest->value.as_map().size() == 10;
  }));
  EXPECT_EQ(hub.newest("events")->value.as_map().begin()->first, "1");
}

TEST_F(HubTest, UnknownDocumentsAndTasksAreErrors) {
  Hub hub(link_, often_);
  for (const std::string name : {"", "secret", "task/", "task/../x", "task/a b", "port/", "port/t", "port/t/",
                                 "port//p", "port/t/p/q", "port/<b>/p"})
    EXPECT_FALSE(hub.subscribe(viewer_, name)) << name;
  ASSERT_TRUE(hub.subscribe(viewer_, "task/gone"));
  ASSERT_TRUE(hub.subscribe(viewer_, "port/t/none"));
  EXPECT_TRUE(eventually([&] {
    const auto task = hub.newest("task/gone");
    const auto port = hub.newest("port/t/none");
    return task && task->error.find("no task") != std::string::npos && port && !port->error.empty();
  }));
}

TEST_F(HubTest, AMissionIsFollowedAsItRunsAndTheNextOneToo) {
  Hub hub(link_, often_);
  const auto shows = [&](std::uint64_t run, std::size_t entries, const Value& plan) {
    return eventually([&] {
      const auto newest = hub.newest("mission");
      const Value* shown = newest ? newest->value.find("entries") : nullptr;
      return shown != nullptr && *newest->value.find("run") == Value(run) &&
             shown->as_map().size() == entries && *newest->value.find("plan") == plan;
    });
  };
  ASSERT_TRUE(hub.subscribe(viewer_, "mission"));
  EXPECT_TRUE(becomes(hub, "mission", Value::map({{"run", 0}})));
  robot_.show_mission(1, "running", 2, Value());
  EXPECT_TRUE(shows(1, 2, Value())) << "its plan comes later";
  const Value outline = Value::map({{"states", Value::List{}}, {"outline", true}});
  robot_.show_mission(1, "running", 2, outline);
  EXPECT_TRUE(shows(1, 2, outline));
  robot_.show_mission(1, "running", 4500, "plan");
  EXPECT_TRUE(shows(1, 4500, "plan")) << "in several answers";
  EXPECT_EQ(hub.newest("mission")->value.find("entries")->find("4500")->find("number")->as_uint(), 4500U);
  robot_.show_mission(2, "running", 4501, Value());
  EXPECT_TRUE(shows(2, 1, Value())) << "what the last one did is gone";
}

}  // namespace
}  // namespace segue::web
