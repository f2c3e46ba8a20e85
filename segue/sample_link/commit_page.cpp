// SPDX-License-Identifier: Apache-2.0
#include <segue/sample_link/commit_page.hpp>

#include <string>

namespace segue::sample_link {

Result<std::shared_ptr<CommitPage>> CommitPage::create() {
  auto file = make_sealed_file("segue-commits", kSize, Writers::CreatorOnly);
  if (!file) return std::move(file.error());
  file->mapping.populate(kSize);
  return std::make_shared<CommitPage>(std::move(*file));
}

Result<std::shared_ptr<const CommitPage>> CommitPage::map(int descriptor) {
  const auto size = check_sealed_file(descriptor, Writers::CreatorOnly);
  if (!size) return size.error();
  if (*size < kSize) {
    return fail(ErrorCode::InvalidArgument, "the runtime offers a page for commits of " +
                                                std::to_string(*size) + " bytes; it has " +
                                                std::to_string(kSize));
  }
  SealedFile file;
  auto mapping = Mapping::of_file(descriptor, kSize, Mapping::Access::Read);
  if (!mapping) return std::move(mapping.error());
  file.mapping = std::move(*mapping);
  auto page = std::make_shared<const CommitPage>(std::move(file));
  // Now, so that no update path does it first.
  static_cast<void>(page->words()->load(std::memory_order_relaxed));
  return page;
}

void CommitPage::commit(std::uint64_t number) noexcept {
  words()[number % kRemembered].store(number, std::memory_order_seq_cst);  // G2 (CommitGate)
}

std::shared_ptr<const task::CommitWord> CommitPage::word(std::uint64_t number) const {
  return {shared_from_this(), words() + number % kRemembered};
}

}  // namespace segue::sample_link
