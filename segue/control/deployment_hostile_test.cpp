// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc_codecs/deployment.capnp.h>
#include <segue/rpc/detail/wire.hpp>
#include <support/fake_deployment.hpp>
#include <support/hostile_client.hpp>

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <cstdlib>

namespace segue::control {
namespace {

using model::ActionKind;
using model::TaskId;
using type::Value;

TEST_F(DeploymentTest, GarbageHalfMessagesAndFloodsDisturbNobody) {
  serve();
  const auto good = client();
  send_garbage(socket_, [&] { return good->info().has_value(); });
  Raw half(socket_);
  half.send(bootstrap_message(0).substr(0, 11));
  Raw endless(socket_);
  const std::string flood = flood_of(100'000);
  EXPECT_LT(endless.send(flood, std::chrono::milliseconds(300)), flood.size() / 2);
  EXPECT_TRUE(half.is_closed());
  EXPECT_TRUE(good->info());
}

TEST_F(DeploymentTest, DescriptorsThatNobodyAskedForAreClosed) {
  serve();
  const auto good = client();
  ASSERT_TRUE(good->info());
  const std::size_t before = open_descriptors();
  const Descriptor file = memory_with("x");
  for (int round = 0; round < 10; ++round) {
    Raw hostile(socket_);
    hostile.send_descriptors(std::vector<int>(200, file.get()));
    hostile.send(bootstrap_message(0).substr(1));
    hostile.send_descriptors(std::vector<int>(200, file.get()));
    ASSERT_TRUE(good->info());
  }
  EXPECT_TRUE(eventually([&] { return open_descriptors() == before + 1; })) << open_descriptors() - before;
}

TEST_F(DeploymentTest, AnotherVersionIsToldBothVersions) {
  serve();
  const Error refused = Speaker(socket_).hello(1, "");
  EXPECT_EQ(refused.code, ErrorCode::Unsupported);
  EXPECT_NE(refused.message.find("speaks version 1;"), std::string::npos) << refused.message;
  EXPECT_NE(refused.message.find("speaks version " + std::to_string(detail::kProtocolVersion) + " of"),
            std::string::npos)
      << refused.message;
}

TEST_F(DeploymentTest, AMemoryOfferWithoutMemoryIsRefused) {
  class Empty final : public wire::Memory::Server {};
  serve();
  Speaker speaker(socket_);
  ASSERT_EQ(speaker.hello(detail::kProtocolVersion, "deployment").message, "");
  const auto admit = [&](bool empty) {
    return speaker.ask([empty](capnp::Capability::Client service) -> kj::Promise<Error> {
      auto request = service.castAs<wire::DeploymentProcess>().admitRequest();
      auto offer = request.initOffer();
      if (empty) {
        offer.setPayload(kj::heap<Empty>());
        offer.setControl(kj::heap<Empty>());
      }
      return request.send().then([](auto&& response) { return detail::decode(response.getError()); });
    });
  };
  EXPECT_EQ(admit(true).code, ErrorCode::ParseError);
  EXPECT_NE(admit(false).message, "");
  EXPECT_TRUE(deployment_.seen()->admitted.empty());
  EXPECT_TRUE(client()->info());
}

TEST_F(DeploymentTest, ActionsThatMakeNoSenseAreRefusedAndTheConnectionLives) {
  serve();
  Speaker speaker(socket_);
  ASSERT_EQ(speaker.hello(detail::kProtocolVersion, "deployment").message, "");
  const auto perform = [&](unsigned kind) {
    return speaker.ask([kind](capnp::Capability::Client service) -> kj::Promise<Error> {
      auto request = service.castAs<wire::DeploymentProcess>().performRequest();
      auto action = request.initActions(1)[0];
      action.setKind(static_cast<std::uint8_t>(kind));
      action.setTask("a");
      request.setTimeout(Duration(kLong).count());
      return request.send().then([](auto&& response) {
        return response.hasError() ? detail::decode(response.getError()) : Error{};
      });
    });
  };
  EXPECT_EQ(perform(200).code, ErrorCode::ParseError);
  EXPECT_NE(perform(static_cast<unsigned>(ActionKind::Connect)).message, "");
  EXPECT_TRUE(deployment_.seen()->performed.empty());
  EXPECT_EQ(perform(static_cast<unsigned>(ActionKind::Stop)).message, "");
  EXPECT_EQ(deployment_.seen()->performed.size(), 1U);
}

TEST_F(DeploymentTest, AClientWithTooManyCallsIsToldSo) {
  serve();
  Speaker speaker(socket_);
  ASSERT_EQ(speaker.hello(detail::kProtocolVersion, "deployment").message, "");
  for (int i = 0; i < 16; ++i) {
    speaker.begin([](capnp::Capability::Client service) {
      auto request = service.castAs<wire::DeploymentProcess>().callRequest();
      request.setOperation("wait");
      request.setTimeout(Duration(kLong).count());
      return request.send().ignoreResult();
    });
  }
  const Error refused = speaker.ask([](capnp::Capability::Client service) -> kj::Promise<Error> {
    return service.castAs<wire::DeploymentProcess>().infoRequest().send().then(
        [](auto&& response) { return response.hasError() ? detail::decode(response.getError()) : Error{}; });
  });
  EXPECT_EQ(refused.code, ErrorCode::ResourceExhausted);
  EXPECT_TRUE(client()->info());
}

TEST_F(DeploymentTest, ListenersThatVanishOrThrowDisturbNobody) {
  class Thrower final : public wire::TaskListener::Server {
    kj::Promise<void> report(ReportContext) override { KJ_FAIL_REQUIRE("I do not want to know"); }
  };
  serve();
  const auto good = client();
  std::atomic<int> got{0};
  good->set_listener([&](const task_host::TaskEvent&) { ++got; });
  const auto listen = [](capnp::Capability::Client service) -> kj::Promise<Error> {
    auto request = service.castAs<wire::DeploymentProcess>().listenRequest();
    request.setListener(kj::heap<Thrower>());
    return request.send().then(
        [](auto&& response) { return response.hasError() ? detail::decode(response.getError()) : Error{}; });
  };
  Speaker thrower(socket_);
  Speaker vanishing(socket_);
  ASSERT_EQ(thrower.hello(detail::kProtocolVersion, "deployment").message, "");
  ASSERT_EQ(vanishing.hello(detail::kProtocolVersion, "deployment").message, "");
  for (int i = 0; i < 4; ++i)
    EXPECT_EQ(thrower.ask(listen).message, "");
  EXPECT_EQ(thrower.ask(listen).code, ErrorCode::ResourceExhausted);
  EXPECT_EQ(vanishing.ask(listen).message, "");
  for (int i = 0; i < 500; ++i) {
    if (i == 250) vanishing.vanish();
    deployment_.tell({TaskId("t"), TaskState::Fatal, ""});
  }
  EXPECT_TRUE(eventually([&] { return got == 500; })) << got;
}

TEST_F(DeploymentTest, FollowersThatVanishOrThrowDisturbNoBatch) {
  class Thrower final : public wire::BatchFollower::Server {
    kj::Promise<void> report(ReportContext) override { KJ_FAIL_REQUIRE("I do not want to know"); }
  };
  class Silent final : public wire::BatchFollower::Server {
    kj::Promise<void> report(ReportContext) override { return kj::NEVER_DONE; }
  };
  serve();
  const auto begin = [](auto make_follower) {
    return [make_follower](capnp::Capability::Client service) -> kj::Promise<void> {
      auto process = service.castAs<wire::DeploymentProcess>();
      auto follow = process.followRequest();
      follow.setFollower(make_follower());
      auto request = process.performRequest();
      auto actions = request.initActions(3);
      for (unsigned i = 0; i < 3; ++i) {
        actions[i].setKind(static_cast<std::uint8_t>(ActionKind::Stop));
        actions[i].setTask(i == 1 ? "wait" : "a");
      }
      request.setTimeout(Duration(kLong).count());
      auto following = follow.send().ignoreResult();
      return request.send().ignoreResult().then(
          [following = kj::mv(following)]() mutable { return kj::mv(following); });
    };
  };
  Speaker thrower(socket_);
  Speaker silent(socket_);
  Speaker vanishing(socket_);
  for (Speaker* one : {&thrower, &silent, &vanishing})
    ASSERT_EQ(one->hello(detail::kProtocolVersion, "deployment").message, "");
  thrower.begin(begin([] { return kj::heap<Thrower>(); }));
  silent.begin(begin([] { return kj::heap<Silent>(); }));
  vanishing.begin(begin([] { return kj::heap<Silent>(); }));
  ASSERT_TRUE(deployment_.entered.wait());
  vanishing.vanish();
  EXPECT_TRUE(client()->info());
  deployment_.release.open();
  const auto good = client()->perform_all(std::vector{action_of(ActionKind::Stop, "a")}, soon());
  EXPECT_TRUE(good.at(0));
}

constexpr const char* kSocketVariable = "SEGUE_TEST_DEPLOYMENT_SOCKET";

/// Not a test: what the next one starts and kills. Tells an event when a call waits.
TEST(DeploymentProcess, DISABLED_ServesUntilItIsKilled) {
  const char* socket = std::getenv(kSocketVariable);
  ASSERT_NE(socket, nullptr);
  FakeDeployment deployment;
  const auto server = Server::listen(socket, &deployment);
  ASSERT_TRUE(server) << to_string(server.error());
  deployment.entered.wait();
  deployment.tell({TaskId("t"), TaskState::Running, "a call waits"});
  Gate().wait();
}

pid_t start_process(const std::filesystem::path& socket) {
  ::setenv(kSocketVariable, socket.c_str(), 1);
  std::string program = "/proc/self/exe";
  std::string filter = "--gtest_filter=DeploymentProcess.DISABLED_ServesUntilItIsKilled";
  std::string disabled = "--gtest_also_run_disabled_tests";
  char* arguments[] = {program.data(), filter.data(), disabled.data(), nullptr};
  pid_t pid = -1;
  EXPECT_EQ(::posix_spawn(&pid, program.c_str(), nullptr, nullptr, arguments, environ), 0);
  return pid;
}

TEST_F(DeploymentTest, AProcessThatIsKilledInACallIsUnavailableAndGoneIsToldOnce) {
  const pid_t pid = start_process(socket_);
  ASSERT_GT(pid, 0);
  ASSERT_TRUE(eventually([&] { return connect_deployment(socket_, soon(), nullptr).has_value(); }));
  std::atomic<int> gone{0};
  Gate waits;
  const auto process = client([&] { ++gone; });
  process->set_listener([&](const task_host::TaskEvent&) { waits.open(); });
  auto call = std::async(std::launch::async, [&] {
    return process->perform_all(std::vector{action_of(ActionKind::Stop, "wait")}, soon());
  });
  EXPECT_TRUE(waits.wait());
  ::kill(pid, SIGKILL);
  ::waitpid(pid, nullptr, 0);
  const auto outcomes = call.get();
  ASSERT_EQ(outcomes.size(), 1U);
  EXPECT_EQ(outcomes[0].error().code, ErrorCode::Unavailable);
  EXPECT_TRUE(eventually([&] { return gone == 1; }));
  EXPECT_EQ(process->info().error().code, ErrorCode::Unavailable);
  EXPECT_EQ(gone, 1);
}

}  // namespace
}  // namespace segue::control
