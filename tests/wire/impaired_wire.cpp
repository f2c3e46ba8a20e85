// SPDX-License-Identifier: Apache-2.0
// Joins network name spaces by a network that delays, reorders, loses and duplicates Ethernet frames as it is
// told to.
//   impaired_wire [--seed NUMBER] STATION=SPACE...
// Makes an interface `eth` in each name space, then prints `ready`. From then on each line of the standard
// input is obeyed (command.hpp) and answered; the wire, and its interfaces, end with the input. Exit status
// 77, with the reason, where the system does not permit it.
#include <sys/epoll.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <iostream>
#include <memory>

#include "wire/command.hpp"
#include "wire/tap.hpp"

namespace segue::wire {
namespace {

constexpr int kSkipped = 77;
constexpr int kFramesInTurn = 64;  // of one station, before others have their turn

Time now() {
  return std::chrono::steady_clock::now().time_since_epoch();
}

class Wire {
 public:
  Wire(std::vector<std::string> stations, const std::vector<std::string>& spaces, std::uint64_t seed)
      : stations_(std::move(stations)), queue_(stations_.size(), seed) {
    for (const std::string& space : spaces) {
      taps_.push_back(std::make_unique<Tap>(space, "eth"));
      watch(taps_.back()->descriptor());
    }
    watch(timer_);
    watch(STDIN_FILENO);
  }

  void run() {
    std::cout << "ready" << std::endl;
    std::array<epoll_event, 16> events;
    while (!ended_) {
      const int count = ::epoll_wait(events_, events.data(), events.size(), -1);
      if (count < 0 && errno != EINTR) throw std::runtime_error("epoll_wait failed");
      for (int i = 0; i < count; ++i)
        handle(events[static_cast<std::size_t>(i)].data.fd);
      deliver();
      set_timer();
    }
  }

 private:
  void watch(int file) const {
    epoll_event event{};
    event.events = EPOLLIN;
    event.data.fd = file;
    if (::epoll_ctl(events_, EPOLL_CTL_ADD, file, &event) != 0) {
      throw std::runtime_error("the input is neither a pipe nor a terminal");
    }
  }

  void handle(int file) {
    if (file == STDIN_FILENO) return read_commands();
    for (std::size_t station = 0; station < taps_.size(); ++station) {
      if (taps_[station]->descriptor() == file) read_frames(station);
    }
  }

  void read_commands() {
    std::array<char, 4096> text;
    const ssize_t size = ::read(STDIN_FILENO, text.data(), text.size());
    if (size <= 0) {
      ended_ = true;
      return;
    }
    input_.append(text.data(), static_cast<std::size_t>(size));
    for (std::size_t end; (end = input_.find('\n')) != std::string::npos; input_.erase(0, end + 1)) {
      std::cout << obey(queue_, stations_, std::string_view(input_).substr(0, end)) << std::endl;
    }
  }

  void read_frames(std::size_t from) {
    std::array<std::byte, 65536> buffer;
    for (int i = 0; i < kFramesInTurn; ++i) {
      const auto frame = taps_[from]->read(buffer);
      if (frame.size() < sizeof(Tap::Address)) return;
      send(from, frame, now());
    }
  }

  /// To the station whose address it bears, or to all others.
  void send(std::size_t from, std::span<const std::byte> frame, Time time) {
    const auto known = std::find_if(taps_.begin(), taps_.end(), [&](const auto& tap) {
      return std::equal(tap->address().begin(), tap->address().end(), frame.begin());
    });
    for (std::size_t to = 0; to < taps_.size(); ++to) {
      if (to != from && (known == taps_.end() || taps_[to] == *known)) queue_.send(from, to, frame, time);
    }
  }

  void deliver() {
    while (auto arrival = queue_.receive(now())) {
      taps_[arrival->to]->write(arrival->frame);
      queue_.recycle(std::move(arrival->frame));
    }
  }

  void set_timer() const {
    itimerspec when{};  // zero: not at all
    if (const auto next = queue_.next()) {
      when.it_value.tv_sec = next->count() / 1'000'000'000;
      when.it_value.tv_nsec = next->count() % 1'000'000'000;
    }
    ::timerfd_settime(timer_, TFD_TIMER_ABSTIME, &when, nullptr);
  }

  std::vector<std::string> stations_;
  FrameQueue queue_;
  std::vector<std::unique_ptr<Tap>> taps_;
  const int events_ = ::epoll_create1(EPOLL_CLOEXEC);
  const int timer_ = ::timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
  std::string input_;
  bool ended_ = false;
};

int usage() {
  std::cerr << "usage: impaired_wire [--seed NUMBER] STATION=SPACE STATION=SPACE...\n";
  return 2;
}

int run(const std::vector<std::string>& arguments) {
  std::vector<std::string> stations, spaces;
  std::uint64_t seed = 1;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    const std::size_t sign = argument.find('=');
    if (argument == "--seed" && i + 1 < arguments.size()) {
      seed = std::strtoull(arguments[++i].c_str(), nullptr, 10);
    } else if (sign == std::string::npos || sign == 0) {
      return usage();
    } else {
      stations.push_back(argument.substr(0, sign));
      spaces.push_back(argument.substr(sign + 1));
    }
  }
  if (stations.size() < 2) return usage();
  try {
    Wire(std::move(stations), spaces, seed).run();
  } catch (const NotPermitted& reason) {
    std::cerr << "skipped: " << reason.what() << "\n";
    return kSkipped;
  } catch (const std::exception& problem) {
    std::cerr << "error: " << problem.what() << "\n";
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace segue::wire

int main(int count, char** arguments) {
  return segue::wire::run({arguments + 1, arguments + count});
}
