// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/endpoint_table.hpp>
#include <segue/deploy/shut_down.hpp>
#include <segue/task_host/test_support.hpp>

#include <support/network_of.hpp>

#include <gmock/gmock.h>

#include <atomic>

namespace segue::deploy::detail {
namespace {

using segue::testing::network_of;
using task_host::testing::soon;
using task_host::testing::wire;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class FakeEndpoint final : public sample_link::SharedEndpoint {
 public:
  void disconnect() override { connected_ = false; }
  [[nodiscard]] bool connected() const override { return connected_; }
  [[nodiscard]] sample_link::Counters counters() const override { return {}; }
  [[nodiscard]] sample_link::Latency latency() const override { return {}; }
  [[nodiscard]] const Policy& policy() const override { return policy_; }
  [[nodiscard]] sample_link::Incarnation peer() const override { return 0; }
  [[nodiscard]] std::uint64_t corrupt() const override { return 0; }
  [[nodiscard]] sample_link::Damage damage(TimePoint /*now*/) override { return sample_link::Damage::None; }
  void end_at(task::CommitGatePtr /*gate*/) override {}
  void settle() override {}
  [[nodiscard]] bool dormant() const override { return false; }
  [[nodiscard]] bool carries() const override { return true; }
  [[nodiscard]] bool owes_samples() const override { return false; }

 private:
  std::atomic<bool> connected_ = true;
  Policy policy_;
};

Endpoint endpoint_of(const model::Connection& connection, Side side, sample_link::Incarnation peer = 1,
                     std::uint64_t offset = 0) {
  Endpoint endpoint{connection, side, {}, peer, std::make_shared<FakeEndpoint>()};
  endpoint.place.offset = offset;
  return endpoint;
}

TEST(EndpointTable, KeepsOneEndpointOfEachConnectionAndSide) {
  const auto connection = wire("a", "out", "b", "in");
  auto other = connection;
  other.policy = {BufferKind::Buffer, 3, Transport::Automatic, false};
  EndpointTable table;
  EXPECT_TRUE(table.add(endpoint_of(connection, Side::Output)));
  EXPECT_TRUE(table.add(endpoint_of(connection, Side::Input)));
  EXPECT_TRUE(table.add(endpoint_of(other, Side::Output)));
  const auto again = table.add(endpoint_of(connection, Side::Output));
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::AlreadyExists);
  EXPECT_EQ(table.connected().size(), 3U);
}

TEST(EndpointTable, AConnectionMayLeadToTwoPeers) {
  const auto connection = wire("a", "out", "b", "in");
  EndpointTable table;
  EXPECT_TRUE(table.add(endpoint_of(connection, Side::Output, 1)));
  EXPECT_TRUE(table.add(endpoint_of(connection, Side::Output, 2)));
  EXPECT_EQ(table.find(connection, Side::Output, 2)->peer, 2U);
  ASSERT_EQ(table.take(connection, Side::Output, 1).size(), 1U);
  EXPECT_FALSE(table.find(connection, Side::Output, 1));
  EXPECT_TRUE(table.find(connection, Side::Output, 2));
}

TEST(EndpointTable, EndpointsThatEndedByThemselvesCountAsAbsent) {
  const auto connection = wire("a", "out", "b", "in");
  EndpointTable table;
  const Endpoint output = endpoint_of(connection, Side::Output);
  const Endpoint input = endpoint_of(connection, Side::Input);
  ASSERT_TRUE(table.add(output));
  ASSERT_TRUE(table.add(input));
  output.shared->disconnect();
  input.shared->disconnect();
  EXPECT_FALSE(table.find(connection, Side::Output, 1));
  EXPECT_FALSE(table.find(connection, Side::Input, 1));
  EXPECT_THAT(table.connected(), IsEmpty());
  EXPECT_TRUE(table.add(endpoint_of(connection, Side::Output)));
  EXPECT_TRUE(table.add(endpoint_of(connection, Side::Input)));
}

TEST(EndpointTable, RemembersThePlacesOfInputsThatEndedUntilTheyAreTaken) {
  const auto connection = wire("a", "out", "b", "in");
  EndpointTable table;
  for (const std::uint64_t offset : {64U, 128U}) {
    const Endpoint input = endpoint_of(connection, Side::Input, 1, offset);
    ASSERT_TRUE(table.add(input));
    input.shared->disconnect();
  }
  EXPECT_THAT(table.connected(), IsEmpty());
  const auto taken = table.take(connection, Side::Input, 1);
  ASSERT_EQ(taken.size(), 2U);
  EXPECT_EQ(taken.front().place.offset + taken.back().place.offset, 192U);
  EXPECT_THAT(table.take(connection, Side::Input, 1), IsEmpty());
}

TEST(EndpointTable, GivesOutTheEndpointsOfAPeer) {
  EndpointTable table;
  ASSERT_TRUE(table.add(endpoint_of(wire("a", "out", "b", "in"), Side::Output, 1)));
  ASSERT_TRUE(table.add(endpoint_of(wire("a", "out", "c", "in"), Side::Output, 2)));
  const auto taken = table.take_of_peer(1);
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken.front().connection.to.task, model::TaskId("b"));
  EXPECT_EQ(table.take_all().size(), 1U);
  EXPECT_THAT(table.connected(), IsEmpty());
}

std::vector<std::string> names(const std::vector<model::TaskId>& ids) {
  std::vector<std::string> names;
  for (const auto& id : ids) {
    names.push_back(id.str());
  }
  return names;
}

TEST(ProducersFirst, PutsEachTaskAfterThoseItReadsFrom) {
  model::Network network;
  for (const char* id : {"c", "x", "b", "a"}) {
    network.tasks.push_back(task_host::testing::task_of(id, "any::Thing"));
  }
  network.connections = {wire("a", "o", "b", "i"), wire("b", "o", "c", "i"), wire("a", "o", "c", "i"),
                         wire("a", "o", "a", "i")};
  EXPECT_THAT(names(producers_first(network)), ElementsAre("x", "a", "b", "c"));
}

TEST(ProducersFirst, CutsCyclesAtTheirFirstTask) {
  model::Network network;
  for (const char* id : {"b", "a", "c"}) {
    network.tasks.push_back(task_host::testing::task_of(id, "any::Thing"));
  }
  network.connections = {wire("a", "o", "b", "i"), wire("b", "o", "a", "i"), wire("b", "o", "c", "i")};
  EXPECT_THAT(names(producers_first(network)), ElementsAre("b", "a", "c"));
}

}  // namespace
}  // namespace segue::deploy::detail
