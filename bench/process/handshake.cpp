// SPDX-License-Identifier: Apache-2.0
#include "handshake.hpp"

#include <cstring>
#include <utility>

#include <sys/socket.h>

namespace bench {
namespace {

using namespace segue::sample_link;
using segue::Descriptor;
using segue::ErrorCode;
using segue::fail;
using segue::Result;

/// The message: both sides send all of it, each fills in its own part.
struct Message {
  Incarnation incarnation = 0;
  std::uint64_t sample_size = 0;
  std::uint64_t flat = 0;
  std::uint64_t offset = 0;
  std::uint64_t generation = 0;
  std::uint64_t hash = 0;
  char type[128] = {};
};

constexpr std::size_t kFiles = 2;
using Control = char[CMSG_SPACE(kFiles * sizeof(int))];

msghdr header_of(iovec& part, Control& control) {
  msghdr header{};
  header.msg_iov = &part;
  header.msg_iovlen = 1;
  header.msg_control = control;
  header.msg_controllen = sizeof control;
  return header;
}

Result<void> send_offer(SharedMemory& memory, int socket, Message message) {
  auto offer = memory.offer();
  if (!offer) return offer.error();
  message.incarnation = offer->incarnation;
  iovec part{&message, sizeof message};
  alignas(cmsghdr) Control control{};
  msghdr header = header_of(part, control);
  cmsghdr* files = CMSG_FIRSTHDR(&header);
  files->cmsg_level = SOL_SOCKET;
  files->cmsg_type = SCM_RIGHTS;
  files->cmsg_len = CMSG_LEN(kFiles * sizeof(int));
  const int descriptors[kFiles] = {offer->payload.get(), offer->control.get()};
  std::memcpy(CMSG_DATA(files), descriptors, sizeof descriptors);
  if (::sendmsg(socket, &header, MSG_NOSIGNAL) != sizeof message)
    return fail(ErrorCode::IoError, "the other process is gone");
  return {};
}

Result<Message> admit_offer(SharedMemory& memory, int socket) {
  Message message;
  iovec part{&message, sizeof message};
  alignas(cmsghdr) Control control{};
  msghdr header = header_of(part, control);
  if (::recvmsg(socket, &header, MSG_WAITALL | MSG_CMSG_CLOEXEC) != sizeof message)
    return fail(ErrorCode::IoError, "the other process is gone");
  int descriptors[kFiles] = {-1, -1};
  if (const cmsghdr* files = CMSG_FIRSTHDR(&header))
    std::memcpy(descriptors, CMSG_DATA(files), sizeof descriptors);
  const MemoryOffer offer{message.incarnation, Descriptor(descriptors[0]), Descriptor(descriptors[1])};
  if (auto done = memory.admit(offer); !done) return done.error();
  return message;
}

}  // namespace

Result<std::shared_ptr<SharedEndpoint>> connect_writer(SharedMemory& memory, int socket,
                                                       segue::task::OutputPortBase& port,
                                                       const segue::Policy& policy) {
  const OutputOrigin origin = describe_output(memory, port);
  Message mine;
  mine.sample_size = origin.sample_size;
  mine.flat = origin.flat ? 1 : 0;
  if (auto done = send_offer(memory, socket, mine); !done) return done.error();
  const auto theirs = admit_offer(memory, socket);
  if (!theirs) return theirs.error();
  InputPlace place;
  place.reader = theirs->incarnation;
  place.offset = theirs->offset;
  place.generation = theirs->generation;
  place.hash = theirs->hash;
  place.type = theirs->type;
  place.port = "reader.input";
  return attach_output(memory, place, port, policy);
}

Result<std::shared_ptr<SharedEndpoint>> connect_reader(SharedMemory& memory, int socket,
                                                       segue::task::InputPortBase& port,
                                                       const segue::Policy& policy) {
  const auto theirs = admit_offer(memory, socket);
  if (!theirs) return theirs.error();
  auto input =
      open_input(memory, {theirs->incarnation, theirs->sample_size, theirs->flat != 0}, port, policy);
  if (!input) return input.error();
  Message mine;
  mine.offset = input->place.offset;
  mine.generation = input->place.generation;
  mine.hash = input->place.hash;
  input->place.type.copy(mine.type, sizeof mine.type - 1);
  if (auto done = send_offer(memory, socket, mine); !done) return done.error();
  return std::move(input->endpoint);
}

}  // namespace bench
