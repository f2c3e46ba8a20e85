// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>

namespace segue::session {

/// Pauses a run: no state or action begins any more; those that run continue. All functions may be called
/// from any thread, before, during and after the run.
class PauseControl {
 public:
  void pause();
  void resume();
  [[nodiscard]] bool paused() const;

  /// For runs, one at a time: `change` is called with every change, and now if it is paused; from whatever
  /// thread, but not after this has been destroyed.
  class Attachment {
   public:
    Attachment(PauseControl* control, std::function<void(bool paused)> change);
    ~Attachment();
    Attachment(const Attachment&) = delete;
    Attachment& operator=(const Attachment&) = delete;

   private:
    PauseControl* const control_;
  };
  /// Blocks until it is not paused, or until stop is requested.
  void wait_until_resumed(const std::stop_token& stop);

 private:
  void set(bool paused);

  mutable std::mutex mutex_;  ///< protects all below; held while `change_` is called
  std::condition_variable_any changed_;
  bool paused_ = false;
  std::function<void(bool)> change_;
};

}  // namespace segue::session
