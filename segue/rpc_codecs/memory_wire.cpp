// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc_codecs/memory_wire.hpp>

#include <fcntl.h>

#include <utility>

namespace segue::control::detail {

namespace {

class MemoryServer final : public wire::Memory::Server {
 public:
  explicit MemoryServer(Descriptor descriptor) : descriptor_(std::move(descriptor)) {}
  kj::Maybe<int> getFd() override { return descriptor_.get(); }

 private:
  Descriptor descriptor_;
};

}  // namespace

wire::Memory::Client encode(Descriptor descriptor) {
  return kj::heap<MemoryServer>(std::move(descriptor));
}

kj::Promise<Result<Descriptor>> decode(wire::Memory::Client memory) {
  auto descriptor = memory.getFd();
  return descriptor.then([memory = kj::mv(memory)](kj::Maybe<int>&& fd) -> Result<Descriptor> {
    KJ_IF_MAYBE (number, fd) {
      Descriptor own(::fcntl(*number, F_DUPFD_CLOEXEC, 0));
      if (!own.valid()) return fail(ErrorCode::ResourceExhausted, "no file descriptors are left");
      return own;
    }
    return fail(ErrorCode::ParseError, "a memory offer came without its file descriptors");
  });
}

void encode(sample_link::MemoryOffer offer, wire::Offer::Builder builder) {
  builder.setIncarnation(offer.incarnation);
  builder.setPayload(encode(std::move(offer.payload)));
  builder.setControl(encode(std::move(offer.control)));
}

kj::Promise<Result<sample_link::MemoryOffer>> decode(wire::Offer::Reader reader) {
  auto control = decode(reader.getControl());
  return decode(reader.getPayload())
      .then([incarnation = reader.getIncarnation(), control = kj::mv(control)](
                Result<Descriptor>&& payload) mutable -> kj::Promise<Result<sample_link::MemoryOffer>> {
        if (!payload) return Result<sample_link::MemoryOffer>(payload.error());
        return control.then([incarnation, payload = std::move(*payload)](
                                Result<Descriptor>&& second) mutable -> Result<sample_link::MemoryOffer> {
          if (!second) return second.error();
          return sample_link::MemoryOffer{incarnation, std::move(payload), std::move(*second)};
        });
      });
}

}  // namespace segue::control::detail
