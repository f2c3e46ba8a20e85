// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/mission.hpp>
#include <segue/mission/program.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace segue::mission {

/// What a run has done, in a file that outlives it: a line of JSON for each action that begins and each that
/// ends. A later run of the same mission takes ends from there instead of executing what has ended, in the
/// order in which it ended, and so comes to where the earlier one broke off. Not thread safe.
///
/// A potentially irreversible action is in the file, and the file on the disk, before it begins. Where the
/// file cannot be written any more the run goes on, `warn` is told once, and the file is emptied: it would
/// tell of less than was done. NaN and infinities, which JSON lacks, become null.
class RunJournal {
 public:
  /// What a run begins with.
  struct Start {
    type::ValueMap inputs;
    std::vector<std::string> facts;
    std::string start_at;
  };
  /// What becomes of potentially irreversible actions that had begun and not ended: executed again; taken as
  /// ended as expected, with default outputs; aborted.
  enum class UnderWay : std::uint8_t { Refuse, Again, Skip, Abort };
  struct End {
    Outcome outcome = 0;
    std::string error;
    bool preempted = false;
    std::vector<type::Value> outputs;
    type::ValueMap globals;           ///< that were set
    std::vector<std::string> erased;  ///< global variables
  };
  using Warn = std::function<void(std::string)>;

  /// AlreadyExists where the file is there, IoError, PermissionDenied.
  static Result<std::unique_ptr<RunJournal>> create(const std::filesystem::path& file, const Mission& mission,
                                                    Start start, Warn warn = {});
  /// NotFound; ParseError where it is no such file, InvalidArgument where it is of another mission;
  /// InvalidState where that run has ended, where another process writes the file, and, for Refuse, where
  /// actions were under way: it names them. What was written last and broke off is cut.
  static Result<std::unique_ptr<RunJournal>> resume(const std::filesystem::path& file, const Mission& mission,
                                                    UnderWay under_way, Warn warn = {});

  [[nodiscard]] const Start& start() const { return start_; }
  /// How many actions the earlier run has ended.
  [[nodiscard]] std::size_t size() const { return ends_.size(); }

  /// Which of the ends is that of this execution.
  [[nodiscard]] std::optional<std::size_t> find(const std::string& path, std::uint64_t iteration) const;
  [[nodiscard]] const End& operator[](std::size_t place) const { return ends_[place]; }
  /// What becomes of it if it was under way; Refuse where it was not.
  [[nodiscard]] UnderWay interrupted(const std::string& path, std::uint64_t iteration) const;

  void began(const std::string& path, std::uint64_t iteration, bool irreversible);
  /// `globals`: all there are, by name.
  void ended(const std::string& path, std::uint64_t iteration, End end, const type::Value& globals);
  void finished(const std::string& outcome);
  /// The run is stopped: what ends from now on ends early and does not count, so that it can go on from here.
  void close() { file_ = Descriptor(); }

 private:
  using Key = std::pair<std::string, std::uint64_t>;

  RunJournal(Descriptor file, Warn warn) : file_(std::move(file)), warn_(std::move(warn)) {}
  Result<void> read(std::string_view text, const Mission& mission, const std::string& name);
  Result<void> take(const type::Value& line);
  [[nodiscard]] std::string open_actions() const;
  void write(const type::ValueMap& line, bool durable);

  Descriptor file_;
  Warn warn_;
  Start start_;
  UnderWay under_way_ = UnderWay::Refuse;
  std::vector<End> ends_;
  std::map<Key, std::size_t> places_;
  std::map<Key, bool> open_;  ///< begun, not ended; irreversible
  bool finished_ = false;
  type::Value globals_;  ///< as the file has them
};

}  // namespace segue::mission
