// SPDX-License-Identifier: Apache-2.0
#include <segue/sample_link/mapping.hpp>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace segue::sample_link {

namespace {

constexpr std::size_t kPage = 4096;
constexpr std::size_t kLargest = std::size_t{1} << 40;

constexpr int seals_of(Writers writers) {
  const int size_seals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;
  return writers == Writers::CreatorOnly ? size_seals | F_SEAL_FUTURE_WRITE : size_seals;
}

Error system_error(const std::string& what) {
  return fail(ErrorCode::ResourceExhausted, what + ": " + std::strerror(errno));
}

}  // namespace

Mapping::~Mapping() {
  if (base_ != nullptr) munmap(base_, size_);
}

Result<Mapping> Mapping::of_file(int descriptor, std::size_t size, Access access) {
  const int protection = access == Access::Read ? PROT_READ : PROT_READ | PROT_WRITE;
  void* base = mmap(nullptr, size, protection, MAP_SHARED | MAP_NORESERVE, descriptor, 0);
  if (base == MAP_FAILED)
    return system_error("cannot map " + std::to_string(size) + " bytes of shared memory");
  return Mapping(static_cast<std::byte*>(base), size);
}

Result<Mapping> Mapping::anonymous(std::size_t size) {
  void* base =
      mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (base == MAP_FAILED) return system_error("cannot map " + std::to_string(size) + " bytes of memory");
  return Mapping(static_cast<std::byte*>(base), size);
}

void Mapping::populate(std::size_t bytes) const noexcept {
  bytes = std::min((bytes + kPage - 1) / kPage * kPage, size_);
  if (bytes == 0) return;
  if (madvise(base_, bytes, MADV_POPULATE_WRITE) != 0) {
    for (std::size_t at = 0; at < bytes; at += kPage) {
      volatile std::byte& page = base_[at];
      page = page;
    }
  }
  // Best effort: without the permission to lock so much, the pages may be swapped out.
  static_cast<void>(mlock(base_, bytes));
}

Result<SealedFile> make_sealed_file(const std::string& name, std::size_t size, Writers writers) {
  size = (size + kPage - 1) / kPage * kPage;
  if (size == 0 || size > kLargest) {
    return fail(ErrorCode::InvalidArgument,
                "shared memory of " + std::to_string(size) + " bytes is not possible; ask for up to 1 TiB");
  }
  SealedFile made;
  made.descriptor = Descriptor(memfd_create(name.c_str(), MFD_CLOEXEC | MFD_ALLOW_SEALING));
  const int file = made.descriptor.get();
  if (file < 0 || ftruncate(file, static_cast<off_t>(size)) != 0)
    return system_error("cannot make shared memory of " + std::to_string(size) + " bytes");
  auto mapping = Mapping::of_file(file, size, Mapping::Access::ReadWrite);
  if (!mapping) return std::move(mapping.error());
  made.mapping = std::move(*mapping);
  if (fcntl(file, F_ADD_SEALS, seals_of(writers)) != 0)
    return system_error("cannot seal shared memory (Linux 5.1 or newer is needed)");
  return made;
}

Result<std::size_t> check_sealed_file(int descriptor, Writers writers) {
  struct stat status {};
  const int seals = fcntl(descriptor, F_GET_SEALS);
  if (seals < 0 || fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode))
    return fail(ErrorCode::InvalidArgument, "the other process offers a file that is not shared memory");
  if ((seals & seals_of(writers)) != seals_of(writers)) {
    return fail(ErrorCode::InvalidArgument,
                "the other process offers shared memory without the seals that keep it from shrinking or "
                "changing it");
  }
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0 || size > kLargest || size % kPage != 0) {
    return fail(ErrorCode::InvalidArgument, "the other process offers shared memory of " +
                                                std::to_string(size) + " bytes, which is not a valid size");
  }
  return size;
}

}  // namespace segue::sample_link
