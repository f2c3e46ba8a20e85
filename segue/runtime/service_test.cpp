// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/runtime_service.hpp>

#include <segue/base/question.hpp>
#include <segue/control/server.hpp>
#include <segue/runtime/runtime_report.hpp>
#include <segue/runtime/test_support.hpp>
#include <segue/type/json.hpp>
#include <support/forwarding_host.hpp>

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

namespace segue::runtime {
namespace {

using ::testing::HasSubstr;

class Service : public ::testing::Test {
 protected:
  Service() {
    EXPECT_FALSE(
        robot_.runtime
            .add_controller(testing::network_of("network: only\ntasks: {a: {component: x::A}, b: {component: "
                                                "x::B}}\nconnections: [a.out -> b.in]\n"))
            .has_errors());
  }
  static TimePoint soon() { return RealClock::instance().now() + std::chrono::seconds(30); }

  testing::StandInRobot robot_;
  int shut_downs_ = 0;
  RuntimeService service_{robot_.runtime, nullptr, [this] { ++shut_downs_; }};
};

TEST_F(Service, ReportsTheStatusThatToolsRelyOn) {
  ASSERT_TRUE(service_.switch_to("only", {}, soon()));
  const auto status = service_.status();
  ASSERT_TRUE(status);
  EXPECT_EQ(status->find("controller")->as_string(), "only");
  EXPECT_EQ(status->find("state")->as_string(), "idle");
  ASSERT_EQ(status->find("tasks")->as_list().size(), 2U);
  const type::Value& task = status->find("tasks")->as_list().front();
  for (const char* field :
       {"id", "component", "state", "host", "process", "pid", "cycle_us", "cpu_us", "missed"}) {
    EXPECT_NE(task.find(field), nullptr) << field;
  }
  EXPECT_EQ(task.find("state")->as_string(), "running");
  EXPECT_EQ(status->find("connections")->as_list().front().find("from")->as_string(), "a.out");
  EXPECT_TRUE(status->find("differences")->as_list().empty());
}

TEST_F(Service, TellsTheHolderOfALeaseWhetherItCommandsWhatRuns) {
  EXPECT_EQ(service_.running(0, soon())->find("lost_to"), nullptr);
  const auto lease = service_.lease("mission patrol");
  ASSERT_TRUE(lease) << to_string(lease.error());
  const std::uint64_t number = (*lease)->number();
  ASSERT_TRUE(service_.switch_to("only", {.lease = number}, soon()));
  const auto before = service_.running(number, soon());
  ASSERT_TRUE(before);
  EXPECT_EQ(*before->find("controller"), type::Value("only"));
  EXPECT_EQ(*before->find("lost_to"), type::Value());
  EXPECT_EQ(*before->find("stopped"), type::Value(false));
  ASSERT_TRUE(service_.switch_to("", {.who = "ann", .take_over = true}, soon()));
  const auto after = service_.running(number, soon());
  ASSERT_TRUE(after);
  EXPECT_EQ(*after->find("lost_to"), type::Value("ann"));
}

TEST_F(Service, CountsWhateverChangesWhatRunsOrWhoCommandsIt) {
  const auto count = [this](std::uint64_t seen) {
    const auto answer = answer_to<std::uint64_t>(soon(), [&](const Wait& wait, control::ChangesAnswer then) {
      service_.changes(seen, wait, std::move(then));
    });
    EXPECT_TRUE(answer);
    return answer.value_or(0);
  };
  const auto lease = service_.lease("mission patrol");
  ASSERT_TRUE(lease) << to_string(lease.error());
  const std::uint64_t number = (*lease)->number();
  std::uint64_t seen = count(0);
  const auto runs = [&] { return service_.running(number, soon()).value_or(type::Value()); };
  ASSERT_FALSE(robot_.runtime
                   .add_controller(testing::network_of(
                       "network: broken\ntasks: {a: {component: x::A, on_failure: report, "
                       "properties: {stand_in: {rate: 1000, fail: [update]}}}}\n"))
                   .has_errors());
  ASSERT_TRUE(service_.switch_to("broken", {.lease = number}, soon()));
  while (runs().find("unresolved")->as_list().empty())
    seen = count(seen);
  ASSERT_TRUE(service_.switch_to("", {.who = "ann", .take_over = true}, soon()));
  while (runs().find("lost_to")->is_null())
    seen = count(seen);
}

TEST_F(Service, ExecutesTransitionsOfTheRobotByTheirNames) {
  Diagnostics found;
  const auto restart = model::read_transition(
      "{from: only, to: only, actions: [{kind: stop, task: a}, {kind: start, task: a, after: [1]}]}",
      "transitions/restart.yaml", found);
  ASSERT_TRUE(restart) << to_string(found);
  ControllerSet set;
  set.transitions = {*restart};
  ASSERT_FALSE(robot_.runtime.load(set).has_errors());
  EXPECT_EQ(*service_.status()->find("transitions"), type::Value::list({"restart"}));
  ASSERT_TRUE(service_.switch_to("only", {}, soon()));
  const auto done = service_.apply_transition({.name = "restart"}, {.who = "ann"}, soon());
  ASSERT_TRUE(done) << to_string(done.error());
  EXPECT_EQ(done->find("outcome")->as_string(), "done");
  EXPECT_EQ(done->find("actions")->as_list().size(), 2U);
  EXPECT_EQ(robot_.runtime.history().back().who, "ann");
  const auto unknown = service_.apply_transition({.name = "restrat"}, {}, soon());
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, HasSubstr("no transition 'restrat', did you mean 'restart'?"));
}

TEST_F(Service, AnswersASwitchWithItsOutcome) {
  const auto planned = service_.diff("only", {}, soon());
  ASSERT_TRUE(planned);
  EXPECT_NE(planned->find("counts"), nullptr);
  const auto done = service_.switch_to("only", {.order = model::Order::Paper}, soon());
  ASSERT_TRUE(done);
  EXPECT_EQ(done->find("outcome")->as_string(), "done");
  EXPECT_EQ(done->find("actions")->as_list().front().find("outcome")->as_string(), "done");
  const auto refused = service_.switch_to("onyl", {}, soon());
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->find("outcome")->as_string(), "refused");
  EXPECT_THAT(refused->find("error")->as_string(), HasSubstr("did you mean 'only'"));
  EXPECT_FALSE(service_.apply_transition({.text = "actions: 3", .file = "t.yaml"}, {}, soon()));
  EXPECT_EQ(service_.history()->as_list().size(), 2U);
  EXPECT_FALSE(service_.events(0, {})->as_list().empty());
}

TEST(ServiceOfComponents, TellsTheirLibrariesOnce) {
  model::ComponentCatalog catalog;
  for (const char* name : {"ros2::Node", "ros2::Publisher"}) {
    model::ComponentModel model;
    model.name = model::ComponentName(name);
    model.library = "segue_components_ros2";
    catalog.add(std::move(model));
  }
  task_host::LibrarySet libraries;
  task_host::LocalTaskHost host{libraries, catalog, {}};
  Runtime runtime("robot", host, catalog);
  RuntimeService service(runtime, nullptr, [] {});
  EXPECT_EQ(*service.status()->find("libraries"), type::Value::list({"segue_components_ros2"}));
}

TEST_F(Service, WithoutFilesThereIsNothingToPlanOrApply) {
  const auto planned = service_.plan("", {}, soon());
  ASSERT_FALSE(planned);
  EXPECT_EQ(planned.error().code, ErrorCode::Unsupported);
  EXPECT_FALSE(service_.apply({}, soon()));
  EXPECT_TRUE(service_.status()->find("changed_files")->as_list().empty());
}

TEST_F(Service, GivesAccessToSingleTasks) {
  ASSERT_TRUE(service_.switch_to("only", {}, soon()));
  const auto task = service_.task("a");
  ASSERT_TRUE(task) << to_string(task.error());
  EXPECT_NE(task->find("timing"), nullptr);
  const auto& histograms = *task->find("histograms");
  for (const char* what : {"updates", "latencies"}) {
    EXPECT_NE(histograms.find(what)->find("p99_us"), nullptr) << what;
    EXPECT_TRUE(histograms.find(what)->find("bins")->is_list()) << what;
  }
  EXPECT_EQ(task->find("ports")->as_list().size(), 2U) << "state and out";
  const auto& models = task->find("property_models")->as_list();
  const auto model = std::ranges::find_if(
      models, [](const type::Value& one) { return *one.find("name") == type::Value("stand_in"); });
  ASSERT_NE(model, models.end());
  EXPECT_EQ(*model->find("live"), type::Value(true));
  EXPECT_TRUE(service_.set_property("a", "stand_in.rate", 5, {.who = "ann"}, soon()));
  EXPECT_FALSE(service_.set_property("a", "stand_in.rate", -5, {}, soon()));
  auto told = service_.events(0, {})->as_list();
  std::erase_if(told, [](const auto& event) { return *event.find("kind") != type::Value("property"); });
  ASSERT_EQ(told.size(), 1U) << "the refused value has changed nothing";
  EXPECT_EQ(*told.back().find("subject"), type::Value("a"));
  EXPECT_EQ(*told.back().find("message"), type::Value("ann set stand_in.rate to 5"));
  EXPECT_FALSE(service_.call("a", "nothing", {}, {}, soon()));
  const auto stream = service_.open_port("a", "state", 5);
  ASSERT_TRUE(stream);
  EXPECT_EQ((*stream)->type_name(), "/int32_t");
  EXPECT_FALSE(service_.task("c"));
  EXPECT_EQ(service_.status()->find("differences")->as_list().size(), 1U) << "the property set by the user";
  ASSERT_TRUE(service_.shut_down());
  EXPECT_EQ(shut_downs_, 1);
}

TEST_F(Service, AnswersNobodyWhoHasStopped) {
  std::stop_source stop;
  stop.request_stop();
  const Wait stopped(std::chrono::hours(1), stop.get_token());
  EXPECT_EQ(service_.task("a", stopped).error().code, ErrorCode::Cancelled);
  EXPECT_EQ(service_.events(1'000'000, stopped).error().code, ErrorCode::Cancelled);
}

/// Its tasks are in processes of a Segue that knows no details of them.
class OlderHost final : public segue::testing::ForwardingHost {
 public:
  using ForwardingHost::ForwardingHost;
  Result<task_host::TaskDetails> details(const model::TaskId& /*task*/) const override {
    return fail(ErrorCode::Unsupported, "runs a segue that cannot do this");
  }
};

TEST(TaskReport, LacksWhatAnOlderProcessCannotTell) {
  model::ComponentCatalog catalog;
  task_host::LibrarySet libraries;
  task_host::LocalTaskHost host{
      libraries, catalog, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  OlderHost older(host);
  Runtime runtime("robot", older, catalog);
  ASSERT_FALSE(runtime.add_controller(testing::network_of("network: only\ntasks: {a: {component: x::A}}\n"))
                   .has_errors());
  ASSERT_EQ(runtime.request(model::NetworkName("only")).get().outcome, Outcome::Done);
  const auto task = task_report(runtime, model::TaskId("a"));
  ASSERT_TRUE(task) << to_string(task.error());
  EXPECT_NE(task->find("timing"), nullptr);
  EXPECT_EQ(task->find("histograms"), nullptr);
  EXPECT_EQ(task->find("log"), nullptr);
}

/// Has lost all connections, and says why, once that is wanted.
class ForgetfulHost final : public segue::testing::ForwardingHost {
 public:
  using ForwardingHost::ForwardingHost;
  std::atomic<bool> forgets{false};

  [[nodiscard]] model::Network observe() const override {
    auto network = ForwardingHost::observe();
    if (forgets) network.connections.clear();
    return network;
  }
  [[nodiscard]] std::vector<task_host::ConnectionReport> connections() const override {
    auto reports = ForwardingHost::connections();
    if (forgets) {
      for (auto& report : reports)
        report.error = "it was overwritten";
    }
    return reports;
  }
};

TEST(StatusReport, SaysWhyAConnectionIsMissing) {
  model::ComponentCatalog catalog;
  task_host::LibrarySet libraries;
  task_host::LocalTaskHost host{
      libraries, catalog, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  ForgetfulHost forgetful(host);
  Runtime runtime("robot", forgetful, catalog);
  ASSERT_EQ(runtime
                .request(testing::network_of("network: only\ntasks: {a: {component: x::A}, b: {component: "
                                             "x::B}}\nconnections: [a.out -> b.in]\n"))
                .get()
                .outcome,
            Outcome::Done);
  forgetful.forgets = true;
  EXPECT_THAT(runtime.observed_differences(),
              ::testing::ElementsAre("connection a.out -> b.in is missing: it was overwritten"));
  forgetful.forgets = false;
}

TEST_F(Service, CancelsNothingWhereNothingIsRequested) {
  const auto nothing = service_.cancel(0, "ann", soon());
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().code, ErrorCode::NotFound);
}

TEST_F(Service, HasAPastOnlyWithAJournal) {
  const auto past = service_.past(type::Value::map({{"ask", "span"}}));
  ASSERT_FALSE(past);
  EXPECT_EQ(past.error().code, ErrorCode::Unsupported);
  EXPECT_THAT(past.error().message, HasSubstr("keeps no journal"));
}

TEST(ServiceWithJournal, TellsAtOnceWhatHasHappened) {
  std::string pattern = ::testing::TempDir() + "segue-service-XXXXXX";
  ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
  RuntimeOptions options;
  options.journal = std::filesystem::path(pattern) / "journal.sqlite";
  {
    testing::StandInRobot robot(std::move(options));
    ASSERT_FALSE(
        robot.runtime.add_controller(testing::network_of("network: only\ntasks: {a: {component: x::A}}"))
            .has_errors());
    RuntimeService service(robot.runtime, nullptr, [] {});
    for (int round = 0; round < 20; ++round) {
      const TimePoint deadline = RealClock::instance().now() + std::chrono::seconds(30);
      ASSERT_TRUE(service.switch_to(round % 2 == 0 ? "only" : "", {}, deadline));
      const auto past = service.past(type::Value::map({{"ask", "requests"}, {"limit", 1}}));
      ASSERT_TRUE(past) << to_string(past.error());
      const auto& requests = past->find("requests")->as_list();
      ASSERT_FALSE(requests.empty());
      EXPECT_EQ(requests.front().find("request")->as_uint(), robot.runtime.history().back().request);
    }
  }
  std::filesystem::remove_all(pattern);
}

/// All numbers in a document, in texts as well.
void collect_numbers(const type::Value& value, std::set<std::uint64_t>& all) {
  const std::string text = type::to_json(value);
  for (std::size_t at = 0; at < text.size();) {
    std::uint64_t number = 0;
    const auto end = std::from_chars(text.data() + at, text.data() + text.size(), number);
    if (end.ec == std::errc() && number != 0) {
      all.insert(number);
    }
    at = std::max(at + 1, static_cast<std::size_t>(end.ptr - text.data()));
  }
}

TEST_F(Service, ObeysNobodyWhoGuessesALeaseOrNamesWhatHeCanRead) {
  const auto socket = std::filesystem::path(::testing::TempDir()) / ("lease-" + std::to_string(::getpid()));
  const auto server = control::Server::listen(socket, &service_);
  ASSERT_TRUE(server) << to_string(server.error());
  const auto owner = control::connect(socket, std::chrono::seconds(30));
  const auto thief = control::connect(socket, std::chrono::seconds(30));
  ASSERT_TRUE(owner && thief);
  const auto lease = (*owner)->lease("mission patrol");
  ASSERT_TRUE(lease) << to_string(lease.error());
  const std::uint64_t number = (*lease)->number();
  ASSERT_TRUE((*owner)->report(number, type::Value::map({{"mission", "patrol"}, {"state", "running"}})));
  ASSERT_TRUE((*owner)->switch_to("only", {.lease = number}, soon()));

  std::set<std::uint64_t> guesses;
  for (std::uint64_t guess = 1; guess <= 100; ++guess) {
    guesses.insert({guess, number + guess, number - guess});
  }
  for (const auto& document :
       {(*thief)->status(), (*thief)->events(0, {}), (*thief)->history(), (*thief)->mission(0, true)}) {
    ASSERT_TRUE(document);
    collect_numbers(*document, guesses);
  }
  EXPECT_FALSE(guesses.contains(number)) << "it can be read";
  for (const std::uint64_t guess : guesses) {
    const auto answer = (*thief)->switch_to("", {.lease = guess}, soon());
    ASSERT_TRUE(answer) << to_string(answer.error());
    EXPECT_EQ(answer->find("outcome")->as_string(), "refused") << guess;
    EXPECT_FALSE((*thief)->report(guess, type::Value("stolen"))) << guess;
  }
  EXPECT_EQ((*owner)->status()->find("controller")->as_string(), "only");
}

}  // namespace
}  // namespace segue::runtime
