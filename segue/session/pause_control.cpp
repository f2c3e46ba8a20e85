// SPDX-License-Identifier: Apache-2.0
#include <segue/session/pause_control.hpp>

#include <utility>

namespace segue::session {

void PauseControl::pause() {
  set(true);
}

void PauseControl::resume() {
  set(false);
}

bool PauseControl::paused() const {
  const std::lock_guard lock(mutex_);
  return paused_;
}

void PauseControl::set(bool paused) {
  const std::lock_guard lock(mutex_);
  if (std::exchange(paused_, paused) == paused) return;
  if (change_) change_(paused);
  changed_.notify_all();
}

void PauseControl::wait_until_resumed(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, stop, [this] { return !paused_; });
}

PauseControl::Attachment::Attachment(PauseControl* control, std::function<void(bool)> change)
    : control_(control) {
  if (control_ == nullptr) return;
  const std::lock_guard lock(control_->mutex_);
  control_->change_ = std::move(change);
  if (control_->paused_) control_->change_(true);
}

PauseControl::Attachment::~Attachment() {
  if (control_ == nullptr) return;
  const std::lock_guard lock(control_->mutex_);
  control_->change_ = {};
}

}  // namespace segue::session
