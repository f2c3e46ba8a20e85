// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/quality.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <array>
#include <span>

namespace segue::ros2 {
namespace {

constexpr std::array<std::string_view, 2> kReliabilities = {"reliable", "best_effort"};
constexpr std::array<std::string_view, 2> kDurabilities = {"volatile", "transient_local"};
constexpr std::array<std::string_view, 2> kLivelinesses = {"automatic", "manual_by_topic"};

template <class Enum>
Result<Enum> parse(std::string_view what, std::string_view text, std::span<const std::string_view> names) {
  const auto* found = std::ranges::find(names.data(), names.data() + names.size(), text);
  if (found != names.data() + names.size()) return static_cast<Enum>(found - names.data());
  std::string all;
  for (const std::string_view name : names)
    all.append(all.empty() ? "" : " or ").append(name);
  return fail(ErrorCode::InvalidArgument,
              std::string(what) + " " + quote(text) + " is not known: expected " + all);
}

std::string in_words(std::chrono::nanoseconds duration) {
  return duration.count() == 0 ? "infinite" : format_duration(duration);
}

/// An offer must be as short as what is requested.
bool is_longer(std::chrono::nanoseconds offered, std::chrono::nanoseconds requested) {
  return requested.count() != 0 && (offered.count() == 0 || offered > requested);
}

}  // namespace

Result<Reliability> parse_reliability(std::string_view text) {
  return parse<Reliability>("reliability", text, kReliabilities);
}
Result<Durability> parse_durability(std::string_view text) {
  return parse<Durability>("durability", text, kDurabilities);
}
Result<Liveliness> parse_liveliness(std::string_view text) {
  return parse<Liveliness>("liveliness", text, kLivelinesses);
}
std::string_view to_string(Reliability reliability) {
  return kReliabilities.at(static_cast<std::size_t>(reliability));
}
std::string_view to_string(Durability durability) {
  return kDurabilities.at(static_cast<std::size_t>(durability));
}
std::string_view to_string(Liveliness liveliness) {
  return kLivelinesses.at(static_cast<std::size_t>(liveliness));
}

std::vector<std::string> mismatches(const Quality& offered, const Quality& requested) {
  std::vector<std::string> found;
  const auto add = [&](std::string_view what, std::string_view offer, std::string_view request) {
    found.push_back(std::string(what) + ": " + std::string(offer) + " is offered, " + std::string(request) +
                    " is requested");
  };
  if (offered.reliability > requested.reliability)
    add("reliability", to_string(offered.reliability), to_string(requested.reliability));
  if (offered.durability < requested.durability)
    add("durability", to_string(offered.durability), to_string(requested.durability));
  if (is_longer(offered.deadline, requested.deadline))
    add("deadline", in_words(offered.deadline), in_words(requested.deadline));
  if (offered.liveliness < requested.liveliness)
    add("liveliness", to_string(offered.liveliness), to_string(requested.liveliness));
  if (is_longer(offered.lease, requested.lease))
    add("lease of liveliness", in_words(offered.lease), in_words(requested.lease));
  return found;
}

}  // namespace segue::ros2
