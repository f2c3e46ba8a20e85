// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/mission_reports.hpp>
#include <segue/type/value_at.hpp>

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <utility>

namespace segue::runtime::detail {

namespace {

using journal::MissionEntry;
using type::Value;

constexpr double kMostAtOnce = 5000;
constexpr double kMostPerSecond = 1000;
/// Bytes; longer texts are cut.
constexpr std::size_t kLongestName = 512;
constexpr std::size_t kLongestError = 2048;
/// Clocks that differ by less count as equal.
constexpr std::int64_t kSameClock = 1'000'000'000;

std::string cut_text_at(const Value& value, std::string_view key, std::size_t longest = kLongestName) {
  return text_at(value, key).substr(0, longest);
}

/// 0 where there is none; never negative.
std::int64_t count_at(const Value& value, std::string_view key) {
  const Value* found = value.find(key);
  if (found == nullptr || !found->is_integer()) return 0;
  if (found->kind() == Value::Kind::Int) return std::max<std::int64_t>(found->as_int(), 0);
  return static_cast<std::int64_t>(std::min(found->as_uint(), std::uint64_t{1} << 62U));
}

std::int64_t nanoseconds(std::chrono::system_clock::time_point time) {
  return std::chrono::duration_cast<Duration>(time.time_since_epoch()).count();
}

std::optional<MissionEntry::Kind> kind_in(const Value& value) {
  const auto* found = std::ranges::find(journal::kMissionKindNames, cut_text_at(value, "kind"));
  if (found == journal::kMissionKindNames.end()) return std::nullopt;
  return static_cast<MissionEntry::Kind>(found - journal::kMissionKindNames.begin());
}

}  // namespace

void MissionReports::begin(std::string holder) {
  holder_ = std::move(holder);
  begun_ = std::chrono::system_clock::now();
  taken_ = 0;
  lost_there_ = 0;
  mission_.reset();
}

void MissionReports::take(Value& doing) {
  if (!doing.is_map()) return;
  take_happened(doing);
  if (Value* plan = doing.as_map().find("plan"); plan != nullptr) {
    recent_.set_plan(std::move(*plan));
    doing.as_map().erase("plan");
  }
}

void MissionReports::take_happened(Value& doing) {
  const Value* happened = doing.find("happened");
  if (happened == nullptr) return;
  refill();
  const std::string mission = cut_text_at(doing, "mission");
  const auto now = std::chrono::system_clock::now();
  const std::int64_t sent = count_at(*happened, "sent_ns");
  const auto apart = std::max(sent, nanoseconds(now)) - std::min(sent, nanoseconds(now));
  const auto sent_at = apart < kSameClock ? WallTime(Duration(sent)) : now;
  const Value* entries = happened->find("entries");
  if (entries != nullptr && entries->is_list()) {
    for (const Value& one : entries->as_list())
      take(one, mission, sent_at, sent);
  }
  const auto lost_there = static_cast<std::uint64_t>(count_at(*happened, "lost"));
  lost_ += lost_there - std::min(lost_there, lost_there_);
  lost_there_ = std::max(lost_there, lost_there_);
  if (credit_ >= 1) tell_lost();
  doing.as_map().erase("happened");
}

/// Its age is by the sender's clock, and counts back from when it was sent.
void MissionReports::take(const Value& one, const std::string& mission, WallTime sent_at, std::int64_t sent) {
  const auto number = static_cast<std::uint64_t>(count_at(one, "number"));
  if (number <= taken_) return;  // its report was sent again, since no answer came
  taken_ = number;
  const auto kind = kind_in(one);
  if (!kind || credit_ < 1) {
    ++lost_;
    return;
  }
  credit_ -= 1;
  const Duration age(std::max<std::int64_t>(sent - count_at(one, "time_ns"), 0));
  MissionEntry entry;
  entry.time = std::clamp(sent_at - std::min<Duration>(age, sent_at - begun_), begun_,
                          std::max(begun_, std::chrono::system_clock::now()));
  entry.kind = *kind;
  entry.who = holder_.substr(0, kLongestName);
  entry.mission = mission;
  entry.action = cut_text_at(one, "action", 2 * kLongestName);
  entry.iteration = static_cast<std::uint64_t>(count_at(one, "iteration"));
  entry.controller = cut_text_at(one, "controller");
  entry.outcome = cut_text_at(one, "outcome");
  entry.error = cut_text_at(one, "error", kLongestError);
  entry.duration = Duration(count_at(one, "duration_ns"));
  entry.mode = cut_text_at(one, "mode");
  add(std::move(entry));
}

void MissionReports::add(MissionEntry entry) {
  if (entry.action.empty() && entry.kind == MissionEntry::Kind::Began) mission_ = entry;
  if (entry.action.empty() && entry.kind == MissionEntry::Kind::Ended) mission_.reset();
  recent_.add(entry);
  journal_.did(std::move(entry));
}

void MissionReports::end(const std::string& why) {
  tell_lost();
  if (!mission_) return;
  MissionEntry entry = *std::exchange(mission_, std::nullopt);
  const auto now = std::chrono::system_clock::now();
  entry.duration = std::max<Duration>(now - entry.time, Duration::zero());
  entry.time = now;
  entry.kind = MissionEntry::Kind::Ended;
  entry.mode.clear();
  entry.outcome = journal::kLost;
  entry.error = why.substr(0, kLongestError);
  recent_.add(entry);
  journal_.did(std::move(entry));
}

void MissionReports::refill() {
  const TimePoint now = RealClock::instance().now();
  const double passed = std::chrono::duration<double>(now - refilled_).count();
  credit_ = std::min(kMostAtOnce, credit_ + kMostPerSecond * passed);
  refilled_ = now;
}

void MissionReports::tell_lost() {
  if (lost_ == 0) return;
  journal_.lost(std::exchange(lost_, 0), "a mission did more than is recorded in that time");
}

}  // namespace segue::runtime::detail
