// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/base/refusal_log.hpp>
#include <segue/rpc/peer.hpp>
#include <segue/web/hub.hpp>
#include <segue/web/page_verbs.hpp>

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>

namespace segue::web {

using control::Role;

/// One browser, whatever carries its messages. It gets
///   {"role", "robot", and where it is so "ros2": true} first,
///   {"document", "version", "skipped", "value" or "change" (from the version that it got before), "error"},
///   {"id", "result"} or {"id", "error": {"code", "message"}}.
/// It is sent the newest version of each document as soon as it has taken the one before; "skipped" says how
/// many it missed meanwhile. So the data that wait for a slow browser are bounded. All functions may be
/// called from any thread.
class Session final : public Viewer, public std::enable_shared_from_this<Session> {
 public:
  struct Identity {
    Role role = Role::Observe;
    std::string robot{};  ///< its name
    std::string who{};    ///< for logs and the robot's journal
    bool ros2 = false;    ///< ServerOptions::has_ros2
  };
  static constexpr std::size_t kMostDocuments = 64;
  /// Answers that the browser has not taken; while there are so many, it should not be read from.
  static constexpr std::size_t kMostAnswers = 32;
  static constexpr std::size_t kLongestAnswer = std::size_t{8} << 20;

  /// `ready`: next() may have something, or is_full() may have ended; called by any thread, must not block.
  static std::shared_ptr<Session> create(Hub& hub, Verbs& verbs, Identity identity,
                                         std::function<void()> ready);
  ~Session() override;

  void receive(std::string_view text);
  /// The next message to be sent; nothing if there is none.
  std::optional<std::string> next();
  [[nodiscard]] bool is_full() const;
  void on_change(const std::string& document) override;

 private:
  Session(Hub& hub, Verbs& verbs, Identity identity, std::function<void()> ready);
  void execute(Command command);
  Result<type::Value> subscribe(const Command& command);
  void answer(std::uint64_t id, const Result<type::Value>& result);
  std::string update(const std::string& name, const std::shared_ptr<const Document>& newest);

  Hub& hub_;
  Verbs& verbs_;
  const Identity identity_;
  const std::function<void()> ready_;
  mutable Mutex mutex_;  ///< protects all below
  std::deque<std::string> answers_ SEGUE_GUARDED_BY(mutex_);
  std::size_t in_progress_ SEGUE_GUARDED_BY(mutex_) = 0;  ///< calls
  /// The version of each watched document that was sent last; null: none yet.
  std::map<std::string, std::shared_ptr<const Document>> sent_ SEGUE_GUARDED_BY(mutex_);
  std::set<std::string> changed_ SEGUE_GUARDED_BY(mutex_);
  RefusalLog refusals_ SEGUE_GUARDED_BY(mutex_){"studio"};
  std::string last_update_ SEGUE_GUARDED_BY(mutex_);  ///< the document that was sent last: others come first
};

}  // namespace segue::web
