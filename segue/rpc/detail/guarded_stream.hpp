// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <capnp/rpc-twoparty.h>
#include <kj/async-io.h>
#include <kj/io.h>

#include <cstddef>
#include <utility>

namespace segue::control::detail {

/// A client that leaves more than this unread is not read from until it has read some. The number of messages
/// counts too, since those that wait form a chain of promises, which is destroyed recursively.
inline constexpr std::size_t kMaxUnreadBytes = std::size_t{16} << 20;
inline constexpr std::size_t kMaxUnreadMessages = 256;
inline constexpr auto kUnreadPause = 10 * kj::MILLISECONDS;

/// Passes all calls on, but does not read from a client that does not read its answers.
class GuardedStream final : public kj::AsyncCapabilityStream {
 public:
  /// `watches_end`: has_ended() will be asked.
  GuardedStream(kj::Own<kj::AsyncCapabilityStream> inner, kj::Timer& timer, bool watches_end)
      : inner_(kj::mv(inner)), timer_(timer), watches_end_(watches_end) {}

  void watch(capnp::TwoPartyVatNetwork& network) { network_ = &network; }
  /// Whether the client has closed, rather than sent what ended the connection.
  [[nodiscard]] bool has_ended() const { return ended_; }

  kj::Promise<size_t> tryRead(void* buffer, size_t minimum, size_t maximum) override {
    if (!is_backed_up()) {
      return watched(inner_->tryRead(buffer, minimum, maximum),
                     [minimum](size_t got) { return got < minimum; });
    }
    return pause().then([this, buffer, minimum, maximum] { return tryRead(buffer, minimum, maximum); });
  }
  kj::Promise<ReadResult> tryReadWithFds(void* buffer, size_t minimum, size_t maximum, kj::AutoCloseFd* fds,
                                         size_t max_fds) override {
    if (!is_backed_up()) {
      return watched(inner_->tryReadWithFds(buffer, minimum, maximum, fds, max_fds),
                     [minimum](const ReadResult& got) { return got.byteCount < minimum; });
    }
    return pause().then([this, buffer, minimum, maximum, fds, max_fds] {
      return tryReadWithFds(buffer, minimum, maximum, fds, max_fds);
    });
  }
  kj::Promise<ReadResult> tryReadWithStreams(void* buffer, size_t minimum, size_t maximum,
                                             kj::Own<kj::AsyncCapabilityStream>* streams,
                                             size_t max_streams) override {
    return inner_->tryReadWithStreams(buffer, minimum, maximum, streams, max_streams);
  }
  kj::Promise<void> write(const void* buffer, size_t size) override { return inner_->write(buffer, size); }
  kj::Promise<void> write(kj::ArrayPtr<const kj::ArrayPtr<const kj::byte>> pieces) override {
    return inner_->write(pieces);
  }
  kj::Promise<void> writeWithFds(kj::ArrayPtr<const kj::byte> data,
                                 kj::ArrayPtr<const kj::ArrayPtr<const kj::byte>> more,
                                 kj::ArrayPtr<const int> fds) override {
    return inner_->writeWithFds(data, more, fds);
  }
  kj::Promise<void> writeWithStreams(kj::ArrayPtr<const kj::byte> data,
                                     kj::ArrayPtr<const kj::ArrayPtr<const kj::byte>> more,
                                     kj::Array<kj::Own<kj::AsyncCapabilityStream>> streams) override {
    return inner_->writeWithStreams(data, more, kj::mv(streams));
  }
  kj::Promise<void> whenWriteDisconnected() override { return inner_->whenWriteDisconnected(); }
  void shutdownWrite() override { inner_->shutdownWrite(); }

 private:
  template <class T, class IsEnd>
  kj::Promise<T> watched(kj::Promise<T> reading, IsEnd is_end) {
    if (!watches_end_) return reading;
    return reading.then(
        [this, is_end](T&& got) -> kj::Promise<T> {
          ended_ = ended_ || is_end(got);
          return got;
        },
        [this](kj::Exception&& exception) -> kj::Promise<T> {
          ended_ = true;
          return kj::mv(exception);
        });
  }

  kj::Promise<void> pause() { return timer_.afterDelay(kUnreadPause); }

  [[nodiscard]] bool is_backed_up() const {
    return network_ != nullptr && (network_->getCurrentQueueSize() > kMaxUnreadBytes ||
                                   network_->getCurrentQueueCount() > kMaxUnreadMessages);
  }

  kj::Own<kj::AsyncCapabilityStream> inner_;
  kj::Timer& timer_;
  capnp::TwoPartyVatNetwork* network_ = nullptr;
  const bool watches_end_;
  bool ended_ = false;
};

}  // namespace segue::control::detail
