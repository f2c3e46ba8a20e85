// SPDX-License-Identifier: Apache-2.0
#include "../process/segue_samples.hpp"
#include "remote.hpp"

#include <segue/task/component_registry.hpp>
#include <segue/task_host/component_library.hpp>

#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <functional>

#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace bench {
namespace {

using segue::type::Value;
using segue::type::ValueMap;

constexpr std::int64_t kGatewayDomain = 78;

/// Runs `body` with one end of a socket in a process of its own, which ends with this one; returns the other.
int start_gateway(const std::function<void(int)>& body) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) std::abort();
  if (::fork() != 0) return ends[0];
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  body(ends[1]);
  for (;;)
    ::pause();
}

/// The link task of a gateway.
std::unique_ptr<segue::task::Task> link_task(const std::string& component, const Route& route,
                                             const Place& mine, const std::string& type, std::size_t bytes) {
  ::setenv("SEGUE_LIBRARY_PATH", SEGUE_BENCH_LIBRARIES, 1);
  static segue::task_host::LibrarySet libraries;
  require(libraries.load("segue_components_gateway"));
  auto made = segue::task::find_component(component)->create();
  if (!made) require(std::move(made.error()));
  auto task = segue::task::Task::create(component, std::move(*made));
  if (!task) require(std::move(task.error()));
  const auto soon = segue::RealClock::instance().now() + std::chrono::seconds(30);
  const segue::Policy policy = policy_for(bytes);
  ValueMap values;
  values.append("topic", "bench_" + std::to_string(::getpgrp()) + "_" + std::to_string(route.run));
  values.append("type", type);
  values.append("policy", std::string(segue::to_string(policy.kind)));
  values.append("size", static_cast<std::int64_t>(policy.size));
  values.append("domain", kGatewayDomain);
  values.append("interface", mine.address);
  values.append("peers", Value::list({Value(route.writer.address), Value(route.reader.address)}));
  require((*task)->set_properties(values, soon));
  require((*task)->configure(soon));
  return std::move(*task);
}

void start(segue::task::Task& task) {
  require(task.start(segue::RealClock::instance().now() + std::chrono::seconds(30)));
}

/// Writer -> Sender: the latter in a process of its own.
template <class T>
std::unique_ptr<Writer> open_remote(const Route& route, std::size_t bytes) {
  enter(route.writer);
  const int socket = start_gateway([&](int other) {
    static const auto memory = memory_for(0);
    static const auto task = link_task("gateway::Sender", route, route.writer,
                                       std::string(segue::type::type_info<T>().name()), bytes);
    static const auto endpoint =
        required(connect_reader(*memory, other, *task->component().find_input("in"), policy_for(bytes)));
    start(*task);
  });
  return std::make_unique<LoanWriter<T>>(socket, bytes);
}

/// Receiver -> reader: the former in a process of its own.
template <class T>
void read_remote(const Route& route, const End& end) {
  enter(route.reader);
  const int socket = start_gateway([&](int other) {
    static const auto memory = memory_for(end.bytes);
    static const auto task = link_task("gateway::Receiver", route, route.reader,
                                       std::string(segue::type::type_info<T>().name()), end.bytes);
    static const auto endpoint = required(
        connect_writer(*memory, other, *task->component().find_output("out"), policy_for(end.bytes)));
    start(*task);
  });
  read_samples<T>(socket, end);
}

class RemoteSegue final : public Transport {
 public:
  RemoteSegue(Route route, Layout layout) : route_(std::move(route)), layout_(layout) {}

  [[nodiscard]] std::string name() const override {
    return layout_ == Layout::Fixed ? "segue, without pointers" : "segue, a vector inside";
  }
  [[nodiscard]] bool carries(std::size_t bytes) const override {
    return layout_ == Layout::Fixed ? is_block(bytes) : bytes > sizeof(Stamp);
  }
  std::unique_ptr<Writer> open(const End& end) override {
    std::unique_ptr<Writer> writer;
    choose(end.bytes, [&]<class T>(T*) { writer = open_remote<T>(route_, end.bytes); });
    return writer;
  }
  void read(const End& end) override {
    choose(end.bytes, [&]<class T>(T*) { read_remote<T>(route_, end); });
  }

 private:
  template <class Use>
  void choose(std::size_t bytes, const Use& use) const {
    if (layout_ == Layout::Vector) return use(static_cast<Grown*>(nullptr));
    with_block(bytes, use);
  }
  Route route_;
  Layout layout_;
};

}  // namespace

std::unique_ptr<Transport> make_remote_segue(const Route& route, Layout layout) {
  return std::make_unique<RemoteSegue>(route, layout);
}

}  // namespace bench
