// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

/// For tests of what is reached from other computers.
namespace segue::doors {

/// Arguments of somebody who wants to see or to do what is not permitted. Random, but the same for each seed.
class HostileValues {
 public:
  explicit HostileValues(std::uint64_t seed) : random_(seed) {}

  /// A text that means something to the robot, such as the name of a task; it is used as it is and changed.
  void learn(std::string text) { known_.push_back(std::move(text)); }
  /// Likewise a number, such as that of a lease.
  void learn(std::uint64_t number) { numbers_.push_back(number); }

  std::string text();
  std::int64_t integer();
  double number();
  bool flag() { return below(2) == 0; }
  type::Value value(int depth = 3);
  /// Less than `count`, which is not 0.
  std::size_t below(std::size_t count);

 private:
  std::string changed(std::string text);

  std::mt19937_64 random_;
  std::vector<std::string> known_;
  std::vector<std::uint64_t> numbers_;
};

}  // namespace segue::doors
