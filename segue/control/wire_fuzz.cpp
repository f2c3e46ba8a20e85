// SPDX-License-Identifier: Apache-2.0
//
// Values and errors out of messages that anybody may have written, under the limits of the server.
#include <segue/control/detail/wire.hpp>

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

/// What was read can be sent on, and arrives as it was.
void check_round_trip(const type::Value& value) {
  if (!check_size(value, kServerMessageWords)) return;
  capnp::MallocMessageBuilder message;
  const auto encoded = encode(value, message.initRoot<wire::Value>());
  require(encoded.has_value(), "a value that was read is not nested too deep to be sent");
  const auto again = decode(message.getRoot<wire::Value>().asReader(), kMaxNodes);
  require(again.has_value(), "a value that was sent can be read");
  require(*again == value, "a value arrives as it went");
}

void read_answer(kj::ArrayPtr<const capnp::word> words) {
  capnp::ReaderOptions options;
  options.traversalLimitInWords = kServerMessageWords;
  options.nestingLimit = kMessageNesting;
  capnp::FlatArrayMessageReader message(words, options);
  const auto answer = decode(message.getRoot<wire::Answer>(), kMaxNodes);
  if (answer) {
    check_round_trip(*answer);
  } else {
    (void)to_string(answer.error());
  }
}

}  // namespace
}  // namespace segue::control::detail

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  std::vector<capnp::word> words(size / sizeof(capnp::word));
  if (!words.empty()) std::memcpy(words.data(), bytes, words.size() * sizeof(capnp::word));
  try {
    segue::control::detail::read_answer({words.data(), words.size()});
  } catch (const kj::Exception&) {  // malformed: the RPC system answers with an error
  }
  return 0;
}
