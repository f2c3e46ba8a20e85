// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/mission.hpp>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace segue::mission::detail {

/// The states before which a run stops. Paths are compared only for states that some breakpoint is at: states
/// of a library have several paths.
class Breakpoints {
 public:
  struct Place {
    std::string path;
    StateIndex state = kNoState;
  };

  void set(std::vector<Place> places) { places_ = std::move(places); }
  /// Sets a breakpoint that is removed as soon as it, or another one, is met.
  void set_once(Place place) { once_ = std::move(place); }
  void forget_once() { once_ = {}; }
  void clear() {
    places_.clear();
    once_ = {};
  }

  /// `path` is called only where it has to be known.
  template <class Path>
  [[nodiscard]] bool has(StateIndex state, const Path& path) const {
    const auto is_at = [&](const Place& place) { return place.state == state && place.path == path(); };
    return is_at(once_) || std::ranges::any_of(places_, is_at);
  }

 private:
  std::vector<Place> places_;  ///< few
  Place once_;
};

}  // namespace segue::mission::detail
