// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <capnp/serialize-async.h>
#include <kj/async-io.h>

namespace segue::control::detail {

/// Messages of a stream whose limits on reading are separate from those on writing: Cap'n Proto applies the
/// limits of messages that it receives to those that it sends, but a server takes small messages from anybody
/// and sends large ones.
class BoundedReads final : public capnp::MessageStream {
 public:
  BoundedReads(kj::AsyncCapabilityStream& stream, capnp::ReaderOptions limits)
      : messages_(stream), limits_(limits) {}

  using capnp::MessageStream::tryReadMessage;
  using capnp::MessageStream::writeMessage;
  using capnp::MessageStream::writeMessages;
  kj::Promise<kj::Maybe<capnp::MessageReaderAndFds>> tryReadMessage(
      kj::ArrayPtr<kj::AutoCloseFd> descriptors, capnp::ReaderOptions /*of the network*/,
      kj::ArrayPtr<capnp::word> scratch) override {
    return messages_.tryReadMessage(descriptors, limits_, scratch);
  }
  kj::Promise<void> writeMessage(kj::ArrayPtr<const int> descriptors,
                                 kj::ArrayPtr<const kj::ArrayPtr<const capnp::word>> segments) override {
    return messages_.writeMessage(descriptors, segments);
  }
  kj::Promise<void> writeMessages(
      kj::ArrayPtr<kj::ArrayPtr<const kj::ArrayPtr<const capnp::word>>> messages) override {
    return messages_.writeMessages(messages);
  }
  kj::Maybe<int> getSendBufferSize() override { return messages_.getSendBufferSize(); }
  kj::Promise<void> end() override { return messages_.end(); }

 private:
  capnp::AsyncCapabilityMessageStream messages_;
  const capnp::ReaderOptions limits_;
};

}  // namespace segue::control::detail
