// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_robot/watched_ports.hpp>

#include <algorithm>

namespace segue::mission {

void WatchedPorts::follow(const Member& port, std::unique_ptr<PortSamples> samples) {
  ports_.emplace_back(port, std::move(samples), bell_);
}

void WatchedPorts::forget(std::string_view task) {
  std::erase_if(ports_, [&](const One& one) { return one.port.task == task; });
}

void WatchedPorts::forget(const Member& port) {
  std::erase_if(ports_, [&](const One& one) { return one.port == port; });
}

Result<void> WatchedPorts::poll() {
  for (One& one : ports_) {
    one.fresh.clear();
    auto answer = one.question.take();
    if (!answer) continue;
    if (!*answer) return answer->error();
    one.fresh = std::move(**answer);
  }
  return {};
}

void WatchedPorts::ask() {
  const TimePoint now = RealClock::instance().now();
  for (One& one : ports_) {
    if (one.question.is_asked() || now < one.ask_at) continue;
    one.ask_at = now + kBetweenSamples;
    one.question.ask(now + kPatience, [&](const Wait& wait, SamplesAnswer answer) {
      one.samples->next(wait, std::move(answer));
    });
  }
}

TimePoint WatchedPorts::next_question() const {
  TimePoint next = TimePoint::max();
  for (const One& one : ports_) {
    if (!one.question.is_asked()) next = std::min(next, one.ask_at);
  }
  return next;
}

std::span<const type::Value> WatchedPorts::fresh(const Member& port) const {
  const One* one = find(port);
  return one == nullptr ? std::span<const type::Value>() : std::span<const type::Value>(one->fresh);
}

const WatchedPorts::One* WatchedPorts::find(const Member& port) const {
  const auto found = std::ranges::find(ports_, port, &One::port);
  return found == ports_.end() ? nullptr : &*found;
}

}  // namespace segue::mission
