// SPDX-License-Identifier: Apache-2.0
#include <segue/base/question.hpp>
#include <segue/base/text.hpp>
#include <segue/control/deployment_client.hpp>
#include <segue/control/host_client.hpp>
#include <segue/control/verbs.hpp>
#include <segue/rpc_tls/credential_files.hpp>
#include <support/fake_deployment.hpp>
#include <support/fake_hosts.hpp>
#include <support/secure_server.hpp>

#include <fstream>
#include <functional>
#include <memory>
#include <set>
#include <vector>

namespace segue::control {
namespace {

using type::Value;

TEST_F(SecureTest, AClientOnTheNetworkIsServedAndNamed) {
  serve_tcp();
  const auto robot = client_of("ann");
  EXPECT_EQ(robot->status().value(), Value::map({{"robot", "fake"}}));
  const auto done = robot->switch_to("explore", {.who = "a test"}, soon()).value();
  EXPECT_EQ(done.find("who")->as_string().find("'ann' (operate) at 127.0.0.1:"), 0U);
  EXPECT_NE(done.find("who")->as_string().find(": a test"), std::string::npos);
}

TEST_F(SecureTest, OneServerMayListenOnASocketAndOnTcp) {
  auto server = Server::listen(Places{socket_, place()}, &robot_);
  ASSERT_TRUE(server);
  server_ = std::move(*server);
  EXPECT_TRUE(client()->shut_down()) << "who connects to the socket administers";
  EXPECT_TRUE(client_of("ann")->status());
  server_.reset();
  EXPECT_FALSE(std::filesystem::exists(socket_));
}

using SecureWherePossible = SecureTest;

TEST_F(SecureWherePossible, Version6OfTheProtocolServesAsWell) {
  auto server = Server::listen(Places{{}, place("::1")}, &robot_);
  if (!server) GTEST_SKIP() << to_string(server.error());
  const auto robot = connect(TcpEndpoint{{"::1", (*server)->port()}, "left", credentials("ann")}, kLong);
  ASSERT_TRUE(robot) << to_string(robot.error());
  EXPECT_TRUE((*robot)->status());
}

TEST_F(SecureTest, LargeAnswersAndManyOfThemArriveWhole) {
  serve_tcp();
  const auto robot = client_of("ann");
  const Value large(std::string(std::size_t{3} << 20, 'x'));
  for (int i = 0; i < 5; ++i)
    EXPECT_EQ(robot->call("t", "echo", large, {}, soon()).value(), large);
  for (int i = 0; i < 200; ++i)
    ASSERT_EQ(robot->call("t", "echo", Value(i), {}, soon()).value(), Value(i));
}

template <class T>
Result<void> outcome(const Result<T>& result) {
  if (!result) return result.error();
  return {};
}

TEST_F(SecureTest, ALeaseServesOnlyWhoGotIt) {
  enrol({.name = "bob", .role = Role::Administer});
  serve_tcp();
  const auto owner = client_of("ann");
  const auto lease = owner->lease("a mission");
  ASSERT_TRUE(lease) << to_string(lease.error());
  const std::uint64_t number = (*lease)->number();
  const auto thief = client_of("bob");
  const Sender sender{.who = "", .lease = number, .beside_mission = false};
  const std::vector<std::pair<std::string, std::function<Result<void>(RobotService&)>>> uses = {
      {"switch", [&](auto& robot) { return outcome(robot.switch_to("a", {.lease = number}, soon())); }},
      {"network",
       [&](auto& robot) {
         return outcome(robot.switch_to_network("tasks: {}", "n.yaml", {.lease = number}, soon()));
       }},
      {"apply", [&](auto& robot) { return outcome(robot.apply({.lease = number}, soon())); }},
      {"repair", [&](auto& robot) { return outcome(robot.repair({.lease = number}, soon())); }},
      {"prepare", [&](auto& robot) { return outcome(robot.prepare({"a"}, number, soon())); }},
      {"report", [&](auto& robot) { return outcome(robot.report(number, Value())); }},
      {"set", [&](auto& robot) { return outcome(robot.set_property("a", "b", Value(1), sender, soon())); }},
      {"call", [&](auto& robot) { return outcome(robot.call("t", "echo", Value(), sender, soon())); }},
      {"write", [&](auto& robot) { return outcome(robot.write("t", "in", Value(1), sender, soon())); }},
      {"give back", [&](auto& robot) { return outcome(robot.give_back(number, false, soon())); }},
  };
  for (const auto& [what, use] : uses) {
    const auto stolen = use(*thief);
    ASSERT_FALSE(stolen) << what;
    EXPECT_EQ(stolen.error().code, ErrorCode::PermissionDenied) << what;
    EXPECT_TRUE(use(*client_of("ann"))) << what << ": also over another connection of hers";
  }
}

struct Question {
  Verb verb;
  std::function<Result<void>(RobotService&)> ask;
  bool takes_over = false;
};

/// Each function of a robot's server at least once.
std::vector<Question> all_questions() {
  const RequestOptions taking{.take_over = true};
  return {
      {Verb::Status, [](auto& robot) { return outcome(robot.status()); }},
      {Verb::Task, [](auto& robot) { return outcome(robot.task("slam")); }},
      {Verb::Watch,
       [](auto& robot) {
         return outcome(answer_to<RobotLevel>(soon(), [&](const Wait& wait, RobotLevelAnswer answer) {
           robot.watch({model::TaskId("slam")}, wait, std::move(answer));
         }));
       }},
      {Verb::Running, [](auto& robot) { return outcome(robot.running(0, soon())); }},
      {Verb::Changes,
       [](auto& robot) {
         return outcome(answer_to<std::uint64_t>(soon(), [&](const Wait& wait, ChangesAnswer answer) {
           robot.changes(0, wait, std::move(answer));
         }));
       }},
      {Verb::Events, [](auto& robot) { return outcome(robot.events(3, {})); }},
      {Verb::History, [](auto& robot) { return outcome(robot.history()); }},
      {Verb::Past, [](auto& robot) { return outcome(robot.past(Value("ask"))); }},
      {Verb::Mission, [](auto& robot) { return outcome(robot.mission(0, false)); }},
      {Verb::Conflicts, [](auto& robot) { return outcome(robot.conflicts({"drive"})); }},
      {Verb::Units, [](auto& robot) { return outcome(robot.units()); }},
      {Verb::SetUnits, [](auto& robot) { return outcome(robot.set_units("screws", 3, "a test")); }},
      {Verb::OpenPort, [](auto& robot) { return outcome(robot.open_port("a", "out", 1)); }},
      {Verb::Plan, [](auto& robot) { return outcome(robot.plan("explore", {}, soon())); }},
      {Verb::Switch, [](auto& robot) { return outcome(robot.switch_to("explore", {}, soon())); }},
      {Verb::Switch,
       [](auto& robot) { return outcome(robot.switch_to_network("tasks: {}", "n.yaml", {}, soon())); }},
      {Verb::Switch, [taking](auto& robot) { return outcome(robot.switch_to("explore", taking, soon())); },
       true},
      {Verb::Switch,
       [taking](auto& robot) {
         return outcome(robot.switch_to_network("tasks: {}", "n.yaml", taking, soon()));
       },
       true},
      {Verb::Apply, [](auto& robot) { return outcome(robot.apply({}, soon())); }},
      {Verb::Apply, [taking](auto& robot) { return outcome(robot.apply(taking, soon())); }, true},
      {Verb::Repair, [](auto& robot) { return outcome(robot.repair({}, soon())); }},
      {Verb::Repair, [taking](auto& robot) { return outcome(robot.repair(taking, soon())); }, true},
      {Verb::Prepare, [](auto& robot) { return outcome(robot.prepare({"drive"}, 0, soon())); }},
      {Verb::Cancel, [](auto& robot) { return outcome(robot.cancel(1, "a test", soon())); }},
      {Verb::ApplyTransition,
       [](auto& robot) { return outcome(robot.apply_transition({.name = "a"}, {}, soon())); }},
      {Verb::ApplyTransition,
       [taking](auto& robot) { return outcome(robot.apply_transition({.name = "a"}, taking, soon())); },
       true},
      {Verb::ResetBelief, [](auto& robot) { return outcome(robot.reset_belief("", "")); }},
      {Verb::Lease, [](auto& robot) { return outcome(robot.lease("a test")); }},
      {Verb::GiveBack, [](auto& robot) { return outcome(robot.give_back(7, false, soon())); }},
      {Verb::Report, [](auto& robot) { return outcome(robot.report(7, Value())); }},
      {Verb::SendCommand, [](auto& robot) { return outcome(robot.send_command("stop", Value())); }},
      {Verb::Stop, [](auto& robot) { return outcome(robot.stop("a test", soon())); }},
      {Verb::ReleaseStop, [](auto& robot) { return outcome(robot.release_stop("a test")); }},
      {Verb::Set, [](auto& robot) { return outcome(robot.set_property("a", "b", Value(1), {}, soon())); }},
      {Verb::Call, [](auto& robot) { return outcome(robot.call("t", "echo", Value(), {}, soon())); }},
      {Verb::TakeInstance,
       [](auto& robot) {
         return outcome(
             answer_to<model::TakenInstance>(soon(), [&](const Wait& wait, model::InstanceAnswer answer) {
               robot.take_instance({"planner"}, wait, std::move(answer));
             }));
       }},
      {Verb::Write, [](auto& robot) { return outcome(robot.write("t", "in", Value(1), {}, soon())); }},
      {Verb::ShutDown, [](auto& robot) { return outcome(robot.shut_down()); }},
  };
}

TEST_F(SecureTest, EachVerbNeedsItsRole) {
  const std::vector<std::pair<std::string, Role>> people = {
      {"olga", Role::Observe}, {"otto", Role::Operate}, {"root", Role::Administer}};
  for (const auto& [name, role] : people)
    enrol({.name = name, .role = role});
  serve_tcp();
  std::set<Verb> asked;
  for (const Question& question : all_questions()) {
    const Role needed = role_for(question.verb, question.takes_over);
    for (const auto& [name, role] : people) {
      const auto answer = question.ask(*client_of(name));
      const bool refused = !answer && answer.error().code == ErrorCode::PermissionDenied;
      const std::string what = name + " asks " + std::string(rule_of(question.verb).name);
      EXPECT_EQ(refused, role < needed) << what;
      if (refused) {
        const std::string expected = quote(name) + " may only " + std::string(to_string(role)) +
                                     " the robot; this needs the role " + std::string(to_string(needed));
        EXPECT_NE(answer.error().message.find(expected), std::string::npos) << answer.error().message;
      }
    }
    asked.insert(question.verb);
  }
  for (const VerbRule& rule : kVerbRules)
    EXPECT_TRUE(asked.contains(rule.verb) || rule.verb >= Verb::LookAtFiles)
        << rule.name << " is asked by nobody";
  EXPECT_TRUE(log_->has({"refused 'olga' (observe) at 127.0.0.1:", "needs the role operate"}));
}

TEST_F(SecureTest, OnlyAdministratorsTakeARobotOverOrHaveATerm) {
  enrol({.name = "root", .role = Role::Administer});
  distributed::testing::Computer left("left");
  serve_tcp(left.local.get());
  const auto refusal = [&](const std::string& name, bool take_over, std::uint64_t term) {
    auto request = distributed::testing::request_of(name, take_over);
    request.term = term;
    const auto robot = connect_host(endpoint(name), soon(), nullptr).value()->acquire(request, soon());
    return robot ? std::nullopt : std::optional(robot.error().code);
  };
  EXPECT_EQ(refusal("ann", true, 0), ErrorCode::PermissionDenied);
  EXPECT_EQ(refusal("ann", false, 7), ErrorCode::PermissionDenied);
  EXPECT_EQ(refusal("ann", false, 0), std::nullopt);
  EXPECT_EQ(refusal("root", true, 1), std::nullopt);
  EXPECT_EQ(connect_host(endpoint("ann"), soon(), nullptr).value()->highest_term("robot").value(), 1U);
  server_.reset();
}

TEST_F(SecureTest, OnlyAdministratorsSetTheEnvironmentOfProcesses) {
  enrol({.name = "root", .role = Role::Administer});
  distributed::testing::Computer left("left");
  serve_tcp(left.local.get());
  for (const std::string name : {"ann", "root"}) {
    const auto host = connect_host(endpoint(name), soon(), nullptr).value();
    const auto robot = host->acquire(distributed::testing::request_of(name, name == "root"), soon()).value();
    model::Deployment plain;
    plain.host = model::HostName("left");
    plain.process = model::ProcessName(name + "_plain");
    model::Deployment with_environment = plain;
    with_environment.process = model::ProcessName(name + "_with_environment");
    with_environment.environment = {{"LD_PRELOAD", "mine.so"}};
    const auto refusal = [&](const model::Deployment& deployment) {
      model::Action deploy;
      deploy.kind = model::ActionKind::Deploy;
      deploy.what = model::DeploymentAction{deployment};
      const auto outcome = robot->perform_all(std::vector{deploy}, soon()).at(0);
      return outcome ? std::nullopt : std::optional(outcome.error().code);
    };
    EXPECT_EQ(refusal(plain), std::nullopt) << name;
    EXPECT_EQ(refusal(with_environment),
              name == "ann" ? std::optional(ErrorCode::PermissionDenied) : std::nullopt);
    EXPECT_EQ(left.world.find(with_environment.process.str()) == nullptr, name == "ann");
  }
  server_.reset();
}

TEST_F(SecureTest, OnlyAdministratorsStartAndEndProcesses) {
  enrol({.name = "root", .role = Role::Administer});
  FakeProcesses processes;
  serve_tcp(&processes);
  const model::DeploymentKey key{model::HostName("left"), model::ProcessName("drive")};
  for (const std::string name : {"ann", "root"}) {
    const auto service = connect_processes(endpoint(name), kLong).value();
    const auto denied = [](const auto& result) {
      return !result && result.error().code == ErrorCode::PermissionDenied;
    };
    EXPECT_TRUE(service->processes("rover"));
    service->set_listener([](const process_server::ProcessInfo&) {});
    process_server::Launch launch;
    launch.robot = "rover";
    EXPECT_EQ(denied(service->start(launch, soon())), name == "ann");
    EXPECT_EQ(denied(service->stop("rover", key, soon())), name == "ann");
    EXPECT_EQ(denied(service->kill("rover", key, soon())), name == "ann");
  }
  server_.reset();
}

TEST_F(SecureTest, AClientWithoutACertificateIsRefused) {
  serve_tcp();
  RawTls stranger(server_->port(), enrolled_, "");
  EXPECT_TRUE(stranger.is_closed());
  EXPECT_NE(stranger.alert().find("certificate required"), std::string::npos) << stranger.alert();
  EXPECT_TRUE(log_->has({"refused a client without a name at 127.0.0.1:", "has shown no certificate"}));
  EXPECT_TRUE(client_of("ann")->status());
}

TEST_F(SecureTest, CertificatesOfAnotherAuthorityAreRefusedByBothSides) {
  serve_tcp();
  auto other = Authority::create(folder_ / "other").value();
  ASSERT_TRUE(other.enrol({.name = "ann", .role = Role::Administer}, folder_ / "foreign"));
  const auto foreign = load_credentials(folder_ / "foreign", CertificateUse::Person).value();
  const auto refused = connect(TcpEndpoint{{"127.0.0.1", server_->port()}, "left", foreign}, kLong);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::PermissionDenied);
  EXPECT_EQ(refused.error().message, "the certificate of 'left' is refused: another authority has issued it");
  EXPECT_TRUE(log_->has({"refused a client", "the client refuses the certificate of this program"}));
  RawTls careless(server_->port(), folder_ / "foreign", "ann");
  EXPECT_TRUE(careless.is_closed());
  EXPECT_TRUE(log_->has({"refused a client that calls itself 'ann' at 127.0.0.1:",
                         "the certificate of 'ann' is refused: another authority has issued it"}));
}

TEST_F(SecureTest, AnExpiredCertificateIsRefused) {
  serve_tcp();
  const auto yesterday = std::chrono::system_clock::now() - std::chrono::hours(24);
  enrol({.name = "late", .role = Role::Operate, .valid = std::chrono::hours(2), .from = yesterday});
  RawTls late(server_->port(), enrolled_, "late");
  EXPECT_TRUE(late.is_closed());
  EXPECT_NE(late.alert().find("certificate expired"), std::string::npos) << late.alert();
  EXPECT_TRUE(log_->has({"a client that calls itself 'late'", "it has expired at 20"}));
}

TEST_F(SecureTest, ARevokedCertificateIsRefusedWithoutARestart) {
  enrol({.name = "eve", .role = Role::Operate});
  serve_tcp();
  const auto eve = endpoint("eve");
  EXPECT_TRUE(connect(eve, kLong).value()->status());
  revoke("eve");
  const auto refused = connect(eve, kLong);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::PermissionDenied);
  EXPECT_EQ(refused.error().message,
            "host 'left' refuses the certificate of this program: it has been revoked");
  EXPECT_TRUE(log_->has({"a client that calls itself 'eve'", "it has been revoked"}));
  EXPECT_TRUE(client_of("ann")->status());
}

TEST_F(SecureTest, WhoIsRevokedWhileConnectedIsCutOff) {
  enrol({.name = "eve", .role = Role::Operate});
  serve_tcp();
  const auto eve = client_of("eve");
  const auto ann = client_of("ann");
  auto waiting = std::async(std::launch::async, [&] { return eve->call("t", "wait", Value(), {}, soon()); });
  ASSERT_TRUE(robot_.entered.wait());
  revoke("eve");
  const auto cut = waiting.get();
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().code, ErrorCode::Unavailable) << to_string(cut.error());
  EXPECT_TRUE(
      log_->has({"refused 'eve' (operate) at 127.0.0.1:", "the certificate of 'eve' has been revoked"}));
  EXPECT_TRUE(ann->status());
}

TEST_F(SecureTest, AClientLeavesAServerThatIsRevokedWhileConnected) {
  serve_tcp();
  const auto ann = client_of("ann");
  auto waiting = std::async(std::launch::async, [&] { return ann->call("t", "wait", Value(), {}, soon()); });
  ASSERT_TRUE(robot_.entered.wait());
  revoke("left");
  const auto left = waiting.get();
  ASSERT_FALSE(left);
  EXPECT_EQ(left.error().code, ErrorCode::PermissionDenied);
  EXPECT_EQ(left.error().message, "the certificate of 'left' has been revoked");
}

TEST_F(SecureTest, OnePersonsConnectionsKeepNobodyElseOut) {
  enrol({.name = "bob", .role = Role::Operate});
  serve_tcp();
  std::vector<std::unique_ptr<RobotService>> crowd;
  while (crowd.size() < 64)
    crowd.push_back(client_of("ann"));
  const auto refused = connect(endpoint("ann"), kLong);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::ResourceExhausted);
  const auto bob = client_of("bob");
  ASSERT_TRUE(bob);
  EXPECT_TRUE(bob->status());
  EXPECT_TRUE(crowd.front()->status());
  EXPECT_FALSE(crowd.back()->status()) << "what was opened last has ended";
}

TEST_F(SecureTest, AListThatCannotBeUsedChangesNothing) {
  enrol({.name = "eve", .role = Role::Operate});
  serve_tcp();
  revoke("eve");
  EXPECT_TRUE(log_->has({"the list of revoked certificates has changed: 1 are"}));
  std::ofstream(enrolled_ / "ca.crl") << "nonsense";
  EXPECT_TRUE(log_->has({"the former list of revoked certificates stays in force"}));
  RawTls eve(server_->port(), enrolled_, "eve");
  EXPECT_TRUE(eve.is_closed());
  EXPECT_NE(eve.alert().find("certificate revoked"), std::string::npos) << eve.alert();
}

TEST_F(SecureTest, AClientRefusesTheServerOfAnotherName) {
  serve_tcp();
  const auto refused = connect(endpoint("ann", "right"), kLong);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::PermissionDenied);
  EXPECT_EQ(refused.error().message,
            "the certificate of 'left' is refused: it is that of 'left', not of 'right'");
}

TEST_F(SecureTest, AClientRefusesARevokedServer) {
  serve_tcp();
  const auto ann = endpoint("ann");
  revoke("left");
  const auto refused = connect(ann, kLong);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "the certificate of 'left' is refused: it has been revoked");
}

TEST_F(SecureTest, OnlyAHostServes) {
  const auto refused = Server::listen(Places{{}, TcpPlace{{"127.0.0.1", 0}, credentials("ann")}}, &robot_);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("'ann' is not that of a host"), std::string::npos);
}

TEST_F(SecureTest, ADeploymentProcessIsNotServedOnTcp) {
  FakeDeployment deployment;
  const auto refused = Server::listen(Places{{}, place()}, &deployment);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::Unsupported);
}

TEST_F(SecureTest, ErrorsOfConnectingTellApart) {
  serve_tcp();
  const std::uint16_t port = server_->port();
  EXPECT_EQ(
      Server::listen(Places{{}, TcpPlace{{"127.0.0.1", port}, place().credentials}}, &robot_).error().code,
      ErrorCode::AlreadyExists);
  auto nobody = endpoint("ann");
  server_.reset();
  const auto refused = connect(nobody, kLong);
  EXPECT_EQ(refused.error().code, ErrorCode::Unavailable);
  EXPECT_NE(refused.error().message.find("nobody listens at '127.0.0.1:"), std::string::npos);
  // No part of a name has more than 63 letters, so the resolver asks no server, which might not answer in
  // time.
  nobody.address = {std::string(64, 'x') + ".invalid", port};
  const auto unknown = connect(nobody, kLong);
  EXPECT_EQ(unknown.error().code, ErrorCode::NotFound) << to_string(unknown.error());
  EXPECT_NE(unknown.error().message.find("there is no computer 'xxx"), std::string::npos)
      << unknown.error().message;
}

TEST_F(SecureTest, AServerThatSaysNothingIsGivenUp) {
  serve_tcp();
  auto silent = endpoint("ann");
  const auto listening = detail::listen_tcp({"127.0.0.1", 0}).value();
  silent.address.port = detail::port_of(listening.get());
  const auto refused = connect(silent, std::chrono::milliseconds(200));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::DeadlineExceeded);
  EXPECT_NE(refused.error().message.find("in the TLS handshake"), std::string::npos);
}

}  // namespace
}  // namespace segue::control
