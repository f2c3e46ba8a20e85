// SPDX-License-Identifier: Apache-2.0
#include "types.hpp"

#include <segue/task/component.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

namespace runtime {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// The runtime's `request` port: other tasks write the names of controllers to it, and the runtime requests
/// these. The runtime looks at it after each of its updates.
class Requests final : public Component {
 public:
  Requests() : Component({.doc = "Requests the controllers whose names other tasks write to it"}) {
    for (std::string& name : newest_)
      name.reserve(kLongestName);
  }

 protected:
  segue::Result<void> on_configure() override {
    // Above the numbers of an earlier incarnation, which the runtime has seen.
    const auto begin = now().time_since_epoch().count();
    first_ = last_ = std::max(last_, static_cast<std::uint64_t>(begin));
    return {};
  }

  segue::Result<void> on_start() override {
    previous_ = nullptr;
    return {};
  }

  void on_update() override {
    while (const auto sample = request_.take())
      note(*sample);
  }

 private:
  static constexpr std::size_t kMost = 16;
  static constexpr std::size_t kLongestName = 1024;  ///< several controllers at once, joined by '+'

  void note(const std::string& name) {
    if (name.size() > kLongestName) {
      log(segue::LogLevel::Error, "a request with a name of more than 1024 bytes is ignored");
      return;
    }
    if (name.empty()) {
      previous_ = nullptr;
      return;
    }
    if (previous_ != nullptr && *previous_ == name) return;
    std::string& place = newest_[++last_ % kMost];
    place.assign(name);
    previous_ = &place;
  }

  RequestedControllers after(std::uint64_t number) const {
    RequestedControllers answer{last_, {}};
    const std::uint64_t kept = last_ - std::min<std::uint64_t>(last_, kMost);
    for (std::uint64_t i = std::max({number, first_, kept}); i < last_; ++i)
      answer.controllers.push_back(newest_[(i + 1) % kMost]);
    return answer;
  }

  InputPort<std::string> request_{
      *this,
      "request",
      {.doc =
           "The name of a controller, of several joined by '+'. A name that repeats the one before requests "
           "nothing; an empty one neither, and the same name is a request again after it"}};
  Operation<RequestedControllers(std::uint64_t)> requests_{
      *this,
      "requests",
      {"after"},
      [this](std::uint64_t number) { return after(number); },
      RunsIn::TaskThread,
      "What was requested after the request of that number; for the runtime"};
  std::array<std::string, kMost> newest_;
  const std::string* previous_ = nullptr;  ///< in newest_; null: any name is a new request
  std::uint64_t first_ = 0;                ///< numbers up to this one are not of this incarnation
  std::uint64_t last_ = 0;
};

}  // namespace runtime

SEGUE_COMPONENT(runtime::Requests)
