// SPDX-License-Identifier: Apache-2.0
//
// Everything that a message can hold, out of messages that anybody may have written, under the limits of the
// server.
#include <segue/rpc_codecs/deployment_wire.hpp>

#include <capnp/message.h>
#include <capnp/serialize.h>
#include <kj/exception.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

namespace segue::control::detail {
namespace {

constexpr std::uint64_t kMaxNodes = 100'000;

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

/// Whatever was decoded can be encoded again and is then decoded as the same.
void check_round_trip(const type::Value& value) {
  if (!check_size(value, kServerMessageWords)) return;
  capnp::MallocMessageBuilder message;
  const auto encoded = encode(value, message.initRoot<wire::Value>());
  require(encoded.has_value(), "a value that was read is not nested too deep to be sent");
  const auto again = decode(message.getRoot<wire::Value>().asReader(), kMaxNodes);
  require(again.has_value(), "a value that was sent can be read");
  require(*again == value, "a value arrives as it went");
}

void read_answer(wire::Answer::Reader reader) {
  const auto answer = decode(reader, kMaxNodes);
  if (answer) {
    check_round_trip(*answer);
  } else {
    (void)to_string(answer.error());
  }
}

/// Whatever can be decoded is encoded, and is the same message after it was decoded and encoded once more.
template <class Wire>
void pass_on(typename Wire::Reader reader) {
  const auto read = decode(reader);
  capnp::MallocMessageBuilder first;
  encode(read, first.initRoot<Wire>());
  if (first.sizeInWords() > kServerMessageWords / 2) return;
  capnp::MallocMessageBuilder second;
  encode(decode(first.getRoot<Wire>().asReader()), second.initRoot<Wire>());
  require(capnp::messageToFlatArray(first).asBytes() == capnp::messageToFlatArray(second).asBytes(),
          "what was read arrives as it went");
}

void read_message(unsigned kind, kj::ArrayPtr<const capnp::word> words) {
  capnp::ReaderOptions options;
  options.traversalLimitInWords = kServerMessageWords;
  options.nestingLimit = kMessageNesting;
  capnp::FlatArrayMessageReader message(words, options);
  switch (kind % 10) {
    case 0:
      return read_answer(message.getRoot<wire::Answer>());
    case 1:
      return pass_on<wire::Transition>(message.getRoot<wire::Transition>());
    case 2:
      return pass_on<wire::Snapshot>(message.getRoot<wire::Snapshot>());
    case 3:
      return pass_on<wire::Component>(message.getRoot<wire::Component>());
    case 4:
      return pass_on<wire::Info>(message.getRoot<wire::Info>());
    case 5:
      return pass_on<wire::OpenInput>(message.getRoot<wire::OpenInput>());
    case 6:
      return pass_on<wire::PlaceOutcome>(message.getRoot<wire::PlaceOutcome>());
    case 7:
      return pass_on<wire::ProcessInfo>(message.getRoot<wire::ProcessInfo>());
    case 8:
      return pass_on<wire::Details>(message.getRoot<wire::Details>());
    default:
      return pass_on<wire::CloseEndpoint>(message.getRoot<wire::CloseEndpoint>());
  }
}

}  // namespace
}  // namespace segue::control::detail

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size == 0) return 0;
  const unsigned kind = bytes[--size];  // last, so that the message is aligned as it would be
  std::vector<capnp::word> words(size / sizeof(capnp::word));
  if (!words.empty()) std::memcpy(words.data(), bytes, words.size() * sizeof(capnp::word));
  try {
    segue::control::detail::read_message(kind, {words.data(), words.size()});
  } catch (const kj::Exception&) {                      // malformed: the RPC system answers with an error
  } catch (const segue::control::detail::WireError&) {  // not a valid value: answered with an error
  }
  return 0;
}
