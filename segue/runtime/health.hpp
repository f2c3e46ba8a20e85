// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <string>
#include <string_view>
#include <vector>

/// Whether a robot has all that it needs.
namespace segue::runtime {

/// Something that the robot needs and that is missing, faulty or given up.
struct Trouble {
  enum class Kind { Robot, Host, Process, Task, Connection, Pool };
  Kind kind = Kind::Robot;
  std::string name;         ///< of the part; of a connection its reader
  std::string what;         ///< a sentence without its full stop: "task 'slam' is in exception"
  std::string why{};        ///< empty: it is not known
  std::string repair{};     ///< what repairs it, or who
  bool on_request = false;  ///< Runtime::repair() repairs it, or tries to
  std::chrono::system_clock::time_point since{};
};
inline constexpr std::array<std::string_view, 6> kTroubleKindNames = {"robot", "host",       "process",
                                                                      "task",  "connection", "pool"};

/// Whether a robot does what it should, and else what is wrong.
struct Health {
  enum class State {
    Healthy,
    InTransition,  ///< whatever is missing may be about to come
    InTrouble,
    Lost  ///< another runtime commands the robot
  };
  State state = State::Healthy;
  std::vector<Trouble> troubles{};
};
inline constexpr std::array<std::string_view, 4> kHealthNames = {"healthy", "in_transition", "in_trouble",
                                                                 "lost"};

}  // namespace segue::runtime
