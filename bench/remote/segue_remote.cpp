// SPDX-License-Identifier: Apache-2.0
#include "../process/handshake.hpp"
#include "../support/chain.hpp"
#include "remote.hpp"

#include <segue/host/component_library.hpp>
#include <segue/task/component_registry.hpp>

#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <vector>

#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace bench {

template <std::size_t N>
struct Frame {
  std::int64_t sent_ns = 0;
  std::uint64_t number = 0;
  std::array<std::uint8_t, N - sizeof(Stamp)> data{};
};
template <>
struct Frame<sizeof(Stamp)> {
  std::int64_t sent_ns = 0;
  std::uint64_t number = 0;
};

struct Image {
  std::int64_t sent_ns = 0;
  std::uint64_t number = 0;
  std::vector<std::uint8_t> data;
};

}  // namespace bench

SEGUE_TYPE(bench::Frame<16>, sent_ns, number)
SEGUE_TYPE(bench::Frame<1000>, sent_ns, number, data)
SEGUE_TYPE(bench::Frame<64000>, sent_ns, number, data)
SEGUE_TYPE(bench::Frame<1000000>, sent_ns, number, data)
SEGUE_TYPE(bench::Frame<10000000>, sent_ns, number, data)
SEGUE_TYPE(bench::Frame<100000000>, sent_ns, number, data)
SEGUE_TYPE(bench::Image, sent_ns, number, data)

namespace bench {
namespace {

namespace link = segue::link;
using segue::task::WriteResult;
using segue::type::Value;
using segue::type::ValueMap;

constexpr std::int64_t kGatewayDomain = 78;

segue::Policy policy_for(std::size_t bytes) {
  return {segue::BufferKind::Buffer, bytes >= 10'000'000 ? 2U : 16U};
}

std::shared_ptr<link::SharedMemory> memory_for(std::size_t bytes) {
  segue::SharedMemoryOptions options;
  options.prefault = std::max(options.prefault, bytes * 4);
  auto memory = link::SharedMemory::create(options);
  if (!memory) require(std::move(memory.error()));
  return std::move(*memory);
}

std::shared_ptr<link::SharedEndpoint> required(segue::Result<std::shared_ptr<link::SharedEndpoint>> made) {
  if (!made) require(std::move(made.error()));
  return std::move(*made);
}

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
  static segue::host::LibrarySet libraries;
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

template <class T>
void prime(segue::task::OutputPort<T>&, std::size_t) {}
void prime(segue::task::OutputPort<Image>& port, std::size_t bytes) {
  port.prime({0, 0, std::vector<std::uint8_t>(bytes - sizeof(Stamp))});
}

template <class T>
class RemoteWriter final : public Writer {
 public:
  RemoteWriter(const Route& route, std::size_t bytes) {
    enter(route.writer);
    const int socket = start_gateway([&](int end) { run_gateway(route, bytes, end); });
    memory_ = memory_for(bytes);
    source_ = std::make_unique<Source<T>>();
    prime(source_->output, bytes);
    endpoint_ = required(connect_writer(*memory_, socket, source_->output, policy_for(bytes)));
  }

  bool send(std::uint64_t number) override {
    auto loan = source_->output.loan();
    if (!loan) return false;
    loan->number = number;
    loan->sent_ns = clock_ns();
    return source_->output.publish(std::move(loan)) == WriteResult::Written;
  }

 private:
  static void run_gateway(const Route& route, std::size_t bytes, int socket) {
    static const auto memory = memory_for(0);
    static const auto task = link_task("gateway::Sender", route, route.writer,
                                       std::string(segue::type::type_info<T>().name()), bytes);
    static const auto endpoint =
        required(connect_reader(*memory, socket, *task->component().find_input("in"), policy_for(bytes)));
    start(*task);
  }

  std::shared_ptr<link::SharedMemory> memory_;
  std::unique_ptr<Source<T>> source_;
  std::shared_ptr<link::SharedEndpoint> endpoint_;
};

/// Records arrivals on the board.
template <class T>
class Noter final : public segue::task::Component {
 public:
  segue::task::InputPort<T> input{*this, "input"};
  Board* board = nullptr;
  std::atomic<bool> ended{false};

  void on_update() override {
    while (auto sample = input.take()) {
      board->arrive({sample->sent_ns, sample->number});
      if (sample->number != kLast) continue;
      ended.store(true, std::memory_order_release);
      ended.notify_one();
    }
  }
};

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
  const auto memory = memory_for(0);
  Bench bench;
  auto component = std::make_unique<Noter<T>>();
  Noter<T>& noter = *component;
  noter.board = &end.board;
  auto task = segue::task::Task::create("noter", std::move(component));
  if (!task) require(std::move(task.error()));
  const auto soon = segue::RealClock::instance().now() + std::chrono::seconds(30);
  require((*task)->configure(soon));
  const auto endpoint = required(connect_reader(*memory, socket, noter.input, policy_for(end.bytes)));
  start(**task);
  noter.ended.wait(false, std::memory_order_acquire);
}

class RemoteSegue final : public Transport {
 public:
  RemoteSegue(Route route, Layout layout) : route_(std::move(route)), layout_(layout) {}

  [[nodiscard]] std::string name() const override {
    return layout_ == Layout::Fixed ? "segue, without pointers" : "segue, a vector inside";
  }
  [[nodiscard]] bool carries(std::size_t bytes) const override {
    return layout_ == Layout::Fixed || bytes > sizeof(Stamp);
  }
  std::unique_ptr<Writer> open(const End& end) override {
    std::unique_ptr<Writer> writer;
    choose(end.bytes, [&]<class T>(T*) { writer = std::make_unique<RemoteWriter<T>>(route_, end.bytes); });
    return writer;
  }
  void read(const End& end) override {
    choose(end.bytes, [&]<class T>(T*) { read_remote<T>(route_, end); });
  }

 private:
  template <class Use>
  void choose(std::size_t bytes, const Use& use) const {
    if (layout_ == Layout::Vector) return use(static_cast<Image*>(nullptr));
    switch (bytes) {
      case 16:
        return use(static_cast<Frame<16>*>(nullptr));
      case 1000:
        return use(static_cast<Frame<1000>*>(nullptr));
      case 64'000:
        return use(static_cast<Frame<64'000>*>(nullptr));
      case 1'000'000:
        return use(static_cast<Frame<1'000'000>*>(nullptr));
      case 10'000'000:
        return use(static_cast<Frame<10'000'000>*>(nullptr));
      default:
        return use(static_cast<Frame<100'000'000>*>(nullptr));
    }
  }
  Route route_;
  Layout layout_;
};

}  // namespace

std::unique_ptr<Transport> make_remote_segue(const Route& route, Layout layout) {
  return std::make_unique<RemoteSegue>(route, layout);
}

}  // namespace bench
