// SPDX-License-Identifier: Apache-2.0
#include "bench_floor.hpp"

#include <segue/base/child_process.hpp>
#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>
#include <segue/base/pipe.hpp>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <latch>
#include <thread>
#include <utility>

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace segue::cli {

namespace {

double seconds_since(TimePoint begin) {
  return std::chrono::duration<double>(RealClock::instance().now() - begin).count();
}

cpu_set_t affinity() {
  cpu_set_t set;
  CPU_ZERO(&set);
  ::sched_getaffinity(0, sizeof set, &set);
  return set;
}

/// Places this thread, and with it what it starts next. Its destructor restores where it ran before.
class Placement {
 public:
  explicit Placement(const Processors& processors) : processors_(processors) { place(0); }
  Placement(const Placement&) = delete;
  Placement& operator=(const Placement&) = delete;
  ~Placement() { ::sched_setaffinity(0, sizeof before_, &before_); }

  /// For the thread or process that is the `index`-th.
  void place(std::size_t index) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<std::size_t>(processors_[index % processors_.size()]), &set);
    ::sched_setaffinity(0, sizeof set, &set);
  }

 private:
  const Processors& processors_;
  const cpu_set_t before_ = affinity();
};

/// A TCP connection in place of a pipe.
Result<Pipe> make_connection() {
  const auto failed = [] {
    return fail(ErrorCode::IoError, "cannot connect this computer with itself by TCP");
  };
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  socklen_t size = sizeof address;
  const Descriptor listener(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (::bind(listener.get(), generic, size) != 0 || ::listen(listener.get(), 1) != 0 ||
      ::getsockname(listener.get(), generic, &size) != 0) {
    return failed();
  }
  Pipe made{Descriptor(), Descriptor(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0))};
  if (::connect(made.write.get(), generic, size) != 0) return failed();
  made.read = Descriptor(::accept4(listener.get(), nullptr, nullptr, SOCK_CLOEXEC));
  const int at_once = 1;
  ::setsockopt(made.write.get(), IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once);
  if (!made.read.valid()) return failed();
  return made;
}

Result<Pipe> make_channel(BenchTransport transport) {
  return transport == BenchTransport::Remote ? make_connection() : make_pipe();
}

/// False at the end of the pipe. Only calls that are safe between fork and exec.
bool read_all(int fd, char* data, std::size_t size) {
  while (size > 0) {
    const ::ssize_t got = ::read(fd, data, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    data += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

bool write_all(int fd, const char* data, std::size_t size) {
  while (size > 0) {
    const ::ssize_t put = ::write(fd, data, size);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    data += put;
    size -= static_cast<std::size_t>(put);
  }
  return true;
}

void relay(int in, int out, std::vector<char>& message) {
  while (read_all(in, message.data(), message.size()) && write_all(out, message.data(), message.size())) {
  }
}

/// In a new process: it must not keep other ends of pipes open, or nobody would see their ends.
[[noreturn]] void relay_process(int in, int out, std::vector<char>& message) {
  const auto low = static_cast<unsigned>(std::min(in, out));
  const auto high = static_cast<unsigned>(std::max(in, out));
  if (low > 0) ::close_range(0, low - 1, 0);
  if (high > low + 1) ::close_range(low + 1, high - 1, 0);
  ::close_range(high + 1, ~0U, 0);
  relay(in, out, message);
  ::_exit(0);
}

/// Relays between two pipes. They end when the first pipe is closed; the destructor waits for that.
class PipeChain {
 public:
  PipeChain() = default;
  PipeChain(const PipeChain&) = delete;
  PipeChain& operator=(const PipeChain&) = delete;
  ~PipeChain() {
    first_ = Descriptor();
    last_ = Descriptor();
    for (std::thread& thread : threads_)
      thread.join();
    for (const ::pid_t child : children_)
      ::waitpid(child, nullptr, 0);
  }

  Result<void> open(BenchTransport transport, std::size_t relays, std::size_t bytes, Placement& placement) {
    auto pipe = make_channel(transport);
    if (!pipe) return pipe.error();
    first_ = std::move(pipe->write);
    last_ = std::move(pipe->read);
    for (std::size_t i = 0; i < relays; ++i) {
      placement.place(i + 1);
      if (auto added = add(transport, bytes); !added) return added;
    }
    return {};
  }

  /// Sends a message through the chain and waits until it has come back.
  bool send(std::vector<char>& message) {
    return write_all(first_.get(), message.data(), message.size()) &&
           read_all(last_.get(), message.data(), message.size());
  }

 private:
  Result<void> add(BenchTransport transport, std::size_t bytes) {
    auto next = make_channel(transport);
    if (!next) return next.error();
    std::vector<char> message(bytes);
    Descriptor in = std::exchange(last_, std::move(next->read));
    if (transport == BenchTransport::Local) {
      threads_.emplace_back(
          [in = std::move(in), out = std::move(next->write), message = std::move(message)]() mutable {
            relay(in.get(), out.get(), message);
          });
      return {};
    }
    const ::pid_t child = ::fork();
    if (child == 0) relay_process(in.get(), next->write.get(), message);
    if (child < 0) return fail(ErrorCode::IoError, "cannot fork a process");
    children_.push_back(child);
    return {};
  }

  Descriptor first_;
  Descriptor last_;
  std::vector<std::thread> threads_;
  std::vector<::pid_t> children_;
};

}  // namespace

Result<BenchFloor> floor_on_processors(
    const std::function<Result<std::vector<double>>(const Processors&)>& measure) {
  const cpu_set_t allowed = affinity();
  Processors two;
  for (std::size_t i = 0; i < CPU_SETSIZE && two.size() < 2; ++i) {
    if (CPU_ISSET(i, &allowed)) two.push_back(static_cast<int>(i));
  }
  BenchFloor floor;
  auto on_one = measure({two.front()});
  if (!on_one) return on_one.error();
  floor.one_processor = std::move(*on_one);
  if (two.size() < 2) return floor;
  auto across = measure(two);
  if (!across) return across.error();
  floor.across = std::move(*across);
  return floor;
}

Result<std::vector<double>> pipe_latencies(BenchTransport transport, std::size_t relays, std::size_t bytes,
                                           std::size_t repetitions, const Processors& processors,
                                           const std::function<bool()>& stopped) {
  constexpr std::size_t kWarmUp = 3;
  Placement placement(processors);
  PipeChain chain;
  if (auto opened = chain.open(transport, relays, bytes, placement); !opened) return opened.error();
  placement.place(0);
  std::vector<char> message(bytes, 'x');
  std::vector<double> latencies;
  for (std::size_t i = 0; i < repetitions + kWarmUp && !stopped(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const auto begin = RealClock::instance().now();
    if (!chain.send(message)) return fail(ErrorCode::IoError, "a relay between pipes has ended");
    if (i >= kWarmUp) latencies.push_back(seconds_since(begin));
  }
  return latencies;
}

std::vector<double> thread_starts(std::size_t count, std::size_t repetitions, const Processors& processors,
                                  const std::function<bool()>& stopped) {
  Placement placement(processors);
  std::vector<double> durations;
  for (std::size_t i = 0; i < repetitions && !stopped(); ++i) {
    const auto begin = RealClock::instance().now();
    std::latch running(static_cast<std::ptrdiff_t>(count) + 1);
    std::vector<std::jthread> threads;
    for (std::size_t n = 0; n < count; ++n) {
      placement.place(n + 1);
      threads.emplace_back([&running] { running.count_down(); });
    }
    placement.place(0);
    running.arrive_and_wait();
    durations.push_back(seconds_since(begin));
  }
  return durations;
}

Result<std::vector<double>> program_runs(std::size_t count, std::size_t repetitions,
                                         const Processors& processors, const std::function<bool()>& stopped) {
  Placement placement(processors);
  std::vector<double> durations;
  for (std::size_t i = 0; i < repetitions && !stopped(); ++i) {
    const auto begin = RealClock::instance().now();
    std::vector<::pid_t> children;
    Result<void> started;
    for (std::size_t n = 0; n < count && started; ++n) {
      placement.place(n + 1);
      ChildProcess child(3);
      auto pid = child.start("true", {"true"});
      if (!pid) {
        started = pid.error();
      } else {
        children.push_back(*pid);
      }
    }
    for (const ::pid_t child : children)
      ::waitpid(child, nullptr, 0);
    if (!started) return started.error();
    durations.push_back(seconds_since(begin));
  }
  return durations;
}

}  // namespace segue::cli
