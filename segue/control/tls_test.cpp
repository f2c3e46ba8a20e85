// SPDX-License-Identifier: Apache-2.0
#include <segue/control/deployment_client.hpp>
#include <support/fake_deployment.hpp>
#include <support/secure_server.hpp>

#include <fstream>
#include <functional>

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

struct Verb {
  const char* name;
  Role needed;
  std::function<Result<void>(RobotService&)> use;
};

template <class T>
Result<void> outcome(const Result<T>& result) {
  if (!result) return result.error();
  return {};
}

std::vector<Verb> all_verbs() {
  return {
      {"status", Role::Observe, [](auto& robot) { return outcome(robot.status()); }},
      {"task", Role::Observe, [](auto& robot) { return outcome(robot.task("slam")); }},
      {"plan", Role::Observe, [](auto& robot) { return outcome(robot.plan("explore", {}, soon())); }},
      {"events", Role::Observe, [](auto& robot) { return outcome(robot.events(3, {})); }},
      {"history", Role::Observe, [](auto& robot) { return outcome(robot.history()); }},
      {"open_port", Role::Observe, [](auto& robot) { return outcome(robot.open_port("a", "out", 1)); }},
      {"switch_to", Role::Operate,
       [](auto& robot) { return outcome(robot.switch_to("explore", {}, soon())); }},
      {"switch_to_network", Role::Operate,
       [](auto& robot) { return outcome(robot.switch_to_network("tasks: {}", "n.yaml", {}, soon())); }},
      {"apply", Role::Operate, [](auto& robot) { return outcome(robot.apply({}, soon())); }},
      {"prepare", Role::Operate, [](auto& robot) { return outcome(robot.prepare({"drive"}, soon())); }},
      {"apply_transition", Role::Operate,
       [](auto& robot) { return outcome(robot.apply_transition("transition: {}", "a.yaml", soon())); }},
      {"reset_belief", Role::Operate, [](auto& robot) { return outcome(robot.reset_belief()); }},
      {"set_property", Role::Operate,
       [](auto& robot) { return outcome(robot.set_property("a", "b", Value(1), {}, soon())); }},
      {"call", Role::Operate,
       [](auto& robot) { return outcome(robot.call("t", "echo", Value(), {}, soon())); }},
      {"shut_down", Role::Operate, [](auto& robot) { return outcome(robot.shut_down()); }},
  };
}

TEST_F(SecureTest, EachVerbNeedsItsRole) {
  enrol({.name = "olga", .role = Role::Observe});
  serve_tcp();
  const auto observer = client_of("olga");
  const auto operator_ = client_of("ann");
  for (const Verb& verb : all_verbs()) {
    const auto seen = verb.use(*observer);
    const bool refused = !seen && seen.error().code == ErrorCode::PermissionDenied;
    EXPECT_EQ(refused, verb.needed > Role::Observe) << verb.name;
    if (refused) {
      EXPECT_NE(seen.error().message.find("'olga' may only observe the robot; this needs the role operate"),
                std::string::npos)
          << seen.error().message;
    }
    const auto done = verb.use(*operator_);
    EXPECT_FALSE(!done && done.error().code == ErrorCode::PermissionDenied) << verb.name;
  }
  EXPECT_TRUE(log_->has({"refused 'olga' (observe) at 127.0.0.1:", "needs the role operate"}));
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
    service->set_listener([](const process::ProcessInfo&) {});
    process::Launch launch;
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
  const auto foreign = Credentials::load(folder_ / "foreign", Credentials::Use::Person).value();
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
  // Until the server has looked at its list again, the connection may still be made.
  if (refused) {
    EXPECT_TRUE(log_->has({"'eve' (operate)", "has been revoked"}));
  }
  const auto again = connect(eve, kLong);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::PermissionDenied);
  EXPECT_EQ(again.error().message,
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
