// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/model/action_times.hpp>
#include <segue/model/transition.hpp>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// What a robot was asked for and what it did, kept in a file that outlives it.
namespace segue::journal {

/// The only outcome of an action from which durations are learnt.
inline constexpr const char* kDone = "done";

/// One action of a transition that was carried out.
struct ActionEntry {
  int id = 0;  ///< in its transition
  model::ActionKind kind = model::ActionKind::Recover;
  model::Phase phase = model::Phase::Commit;
  std::string label;      ///< "stop area_explorer"
  std::string component;  ///< as in model::ActionKey
  model::HostName host;
  model::ProcessName process;  ///< empty: the runtime's own
  Duration started{0};         ///< since the begin of the execution
  Duration waited{0};  ///< though what comes before it was done: for others of its batch, and on the way
  Duration duration{0};
  std::string outcome;  ///< "done", "failed", "skipped"
  std::string error;

  friend bool operator==(const ActionEntry&, const ActionEntry&) = default;
};

/// What was expected of a transition before it was carried out.
struct Prediction {
  model::DurationRange total;
  model::DurationRange commit;
  friend bool operator==(const Prediction&, const Prediction&) = default;
};

/// What became of a request. `total` is from the begin of the execution to the end of its last action;
/// solving comes before it.
struct TransitionEntry {
  std::uint64_t request = 0;
  std::chrono::system_clock::time_point time;  ///< when it ended
  std::string cause;                           ///< "request", "repair", "fallback" ...
  std::string who;                             ///< asked; may be empty
  std::string from;
  std::string to;
  std::string runs;  ///< what the robot runs since
  std::string order;
  std::string outcome;  ///< "done", "superseded", "refused", "failed" ...
  std::string undone;   ///< how, where it failed: "restored", "fell back to 'safe'" ...
  std::string error;
  Duration solve{0};
  Duration total{0};
  Duration prepare{0};
  Duration commit{0};
  Duration retire{0};
  std::optional<Prediction> predicted;
  std::vector<ActionEntry> actions;

  friend bool operator==(const TransitionEntry&, const TransitionEntry&) = default;
};

/// A request that was accepted. One without a transition of the same number was cut off: the runtime ended.
struct RequestEntry {
  std::uint64_t request = 0;
  std::chrono::system_clock::time_point time;
  std::string who;
  std::string what;  ///< the network's name
  friend bool operator==(const RequestEntry&, const RequestEntry&) = default;
};

/// Where what runs was found to differ from what should, and what was done about it.
struct DifferenceEntry {
  std::chrono::system_clock::time_point time;
  std::string subject;   ///< task, process or connection
  std::string sentence;  ///< "task 'slam' is in exception"
  std::string done;      ///< "reported", "restarted" ...; may be empty
  friend bool operator==(const DifferenceEntry&, const DifferenceEntry&) = default;
};

/// Entries that could not be kept: the disk was full, the file not to be written.
struct GapEntry {
  std::chrono::system_clock::time_point time;  ///< when writing went on
  std::uint64_t lost = 0;
  std::string reason;
  friend bool operator==(const GapEntry&, const GapEntry&) = default;
};

/// What is learnt from a transition: how long each action that was done took, and how long it waited.
struct Lesson {
  std::vector<std::pair<model::ActionKey, Duration>> actions;
  std::vector<Duration> waits;
};
Lesson lesson_of(const TransitionEntry& entry);

}  // namespace segue::journal
