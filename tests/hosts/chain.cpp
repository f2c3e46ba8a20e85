// SPDX-License-Identifier: Apache-2.0
#include "chain.hpp"

#include <support/eventually.hpp>

namespace segue::testing {

namespace {

using type::Value;

/// Buffers for ten seconds, so that no sample is refused on a busy computer.
constexpr const char* kBuffer = ", policy: buffer, size: 10000}\n";
constexpr const char* kPeriodic = ", activity: {periodic: 2ms}";

std::string link(const std::string& from, const std::string& to) {
  return "  - {from: " + from + ", to: " + to + kBuffer;
}

std::string task(const std::string& name, const std::string& component, const std::string& more = {}) {
  return "  " + name + ": {component: \"" + component + "\"" + more + "}\n";
}

std::string process(const std::string& name, const std::string& host, const std::string& tasks) {
  return "  " + name + ": {host: " + host + ", tasks: [" + tasks + "]}\n";
}

std::string network(const std::string& name, const std::string& tasks, const std::string& deployments,
                    const std::string& connections) {
  return "network: " + name + "\ntasks:\n" + tasks + "deployments:\n" + deployments + "connections:\n" +
         connections;
}

std::uint64_t number(const Value& value, const char* key) {
  const Value* found = value.find(key);
  return found == nullptr ? 0 : static_cast<std::uint64_t>(found->as_int());
}

std::string chain_ends() {
  return task("producer", "bench::Producer", kPeriodic) + task("consumer", "bench::Consumer");
}
std::string processes_of_ends() {
  return process("front", "a", "producer") + process("back", "a", "consumer");
}
std::string chain_tasks() {
  return chain_ends() + task("relay", "bench::Relay");
}
std::string chain_processes() {
  return processes_of_ends() + process("work", "b", "relay");
}
std::string chain_connections() {
  return link("producer.out", "relay.in") + link("relay.out", "consumer.in");
}

}  // namespace

void ChainTest::add_to_chain(const std::string& name, const std::string& tasks,
                             const std::string& deployments, const std::string& connections) const {
  write("robot/" + name + ".net",
        testing::network(name, chain_tasks() + tasks, chain_processes() + deployments,
                         chain_connections() + connections));
}

void ChainTest::make_chain(const std::vector<std::string>& optional_hosts, const std::string& slow) {
  make_hosts({"a", "b"});
  write_robot("libraries: [segue_components_bench]\n", optional_hosts);
  const std::string step = slow.empty() ? "0ms" : slow;
  write("slow.yaml", "stand_ins:\n  default: {configure: " + step + ", start: " + step + ", stop: " + step +
                         ", cleanup: " + step + "}\n");
  const auto add = [this](const std::string& name, const std::string& tasks, const std::string& deployments,
                          const std::string& connections) {
    write("robot/" + name + ".net", testing::network(name, tasks, deployments, connections));
  };
  add_to_chain("plain");
  add_to_chain("more", task("arm", "x::Arm") + task("plan", "x::Plan") + task("look", "x::Look"),
               process("left", "a", "arm, look") + process("right", "b", "plan"),
               "  - arm.pose -> plan.pose\n  - plan.path -> arm.path\n  - look.seen -> plan.seen\n");
  add("other", chain_ends() + task("relay2", "bench::Relay"),
      processes_of_ends() + process("work2", "b", "relay2"),
      link("producer.out", "relay2.in") + link("relay2.out", "consumer.in"));
  add("still",
      task("producer", "bench::Producer", std::string(kPeriodic) + ", state: stopped") +
          task("consumer", "bench::Consumer") + task("relay", "bench::Relay"),
      chain_processes(), chain_connections());
  add("near", chain_ends(), processes_of_ends(), link("producer.out", "consumer.in"));
}

void ChainTest::start_chain(const std::string& controller, const std::vector<std::string>& more) {
  std::vector<std::string> options = {"--stand-ins", "slow.yaml"};
  options.insert(options.end(), more.begin(), more.end());
  start_robot(options);
  if (controller.empty()) return;
  switch_to("still");  // so that the producer's first sample finds its connection
  switch_to(controller);
  EXPECT_EQ(what_stays_wrong(HostsTest::network(controller)), "");
}

ChainTest::Counted ChainTest::counted(const std::string& consumer) {
  const auto statistics = json({"call", consumer + ".statistics"});
  return {number(statistics, "count"), number(statistics, "lost"), number(statistics, "late")};
}

void ChainTest::wait_for_more() {
  const auto before = counted();
  EXPECT_TRUE(eventually([&] { return counted().count > before.count + 20; }))
      << "the consumer gets nothing any more, after " << before.count << " samples";
}

void ChainTest::expect_flow() {
  wait_for_more();
  EXPECT_EQ(counted().lost, 0U);
}

std::uint64_t ChainTest::updates(const std::string& task) {
  const auto now = status();
  for (const Value& one : now.find("tasks")->as_list()) {
    if (*one.find("id") == Value(task)) return number(one, "cycles");
  }
  ADD_FAILURE() << "no task " << task;
  return 0;
}

ChainTest::Flow ChainTest::flow(const std::string& from, const std::string& to) {
  const auto now = status();
  for (const Value& one : now.find("connections")->as_list()) {
    if (*one.find("from") == Value(from) && *one.find("to") == Value(to))
      return {number(one, "written"), number(one, "read"), number(one, "dropped")};
  }
  ADD_FAILURE() << "no connection " << from << " -> " << to;
  return {};
}

void ChainTest::expect_all_arrived() {
  switch_to("still");
  const std::uint64_t written = updates("producer");
  const bool all = eventually([&] { return counted().count >= written; });
  const auto at_end = counted();
  EXPECT_TRUE(all) << at_end.count << " of " << written << " samples have arrived";
  EXPECT_EQ(at_end.count, written) << "each once";
  EXPECT_EQ(at_end.lost, 0U) << "and in order";
  EXPECT_EQ(flow("producer.out", "relay.in").dropped, 0U);
  EXPECT_EQ(flow("relay.out", "consumer.in").dropped, 0U);
}

std::uint64_t ChainTest::expect_each_once_and_in_order() {
  const std::uint64_t lost = expect_each_once();
  EXPECT_EQ(counted().late, 0U);
  return lost;
}

std::uint64_t ChainTest::expect_each_once() {
  switch_to("still");
  const std::uint64_t written = updates("producer");
  Counted at_end;
  const bool all = eventually([&] {
    at_end = counted();
    return at_end.count + at_end.lost >= written;
  });
  EXPECT_TRUE(all) << at_end.count << " have arrived, " << at_end.lost << " are missing, of " << written;
  EXPECT_EQ(at_end.count + at_end.lost, written);
  return at_end.lost;
}

}  // namespace segue::testing
