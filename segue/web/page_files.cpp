// SPDX-License-Identifier: Apache-2.0
#include <segue/web/page_files.hpp>

#include <segue/base/file.hpp>
#include <segue/base/folders.hpp>
#include <segue/base/text.hpp>

#include <system_error>
#include <utility>

namespace segue::web {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestPage = std::size_t{64} << 20;

std::string_view type_of(const fs::path& file) {
  static const std::map<std::string, std::string_view, std::less<>> types = {
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".woff2", "font/woff2"},
      {".json", "application/json"},
      {".txt", "text/plain; charset=utf-8"}};
  const auto found = types.find(file.extension().string());
  return found == types.end() ? std::string_view() : found->second;
}

}  // namespace

Result<PageFiles> PageFiles::read(const fs::path& folder) {
  PageFiles page;
  std::size_t size = 0;
  std::error_code problem;
  for (fs::recursive_directory_iterator at(folder, problem), end; !problem && at != end;
       at.increment(problem)) {
    const std::string_view type = type_of(at->path());
    if (type.empty() || at->is_symlink(problem) || !at->is_regular_file(problem)) continue;
    auto content = read_file(at->path(), kLargestPage);
    if (!content) return content.error();
    size += content->size();
    if (size > kLargestPage)
      return fail(ErrorCode::ResourceExhausted, quote(folder.string()) + " is larger than 64 MiB");
    page.files_.emplace("/" + fs::relative(at->path(), folder, problem).generic_string(),
                        File{std::move(*content), type});
  }
  if (page.find("/") == nullptr)
    return fail(ErrorCode::NotFound, "there is no page in " + quote(folder.string()) + " (no index.html)");
  return page;
}

Result<fs::path> PageFiles::installed() {
  std::error_code ignored;
  for (const fs::path& prefix : install_prefixes()) {
    fs::path folder = prefix / "share" / "segue" / "studio";
    if (fs::exists(folder / "index.html", ignored)) return folder;
  }
  return fail(ErrorCode::NotFound,
              "the page of the studio is not installed; it is built with Segue where node and npm are there "
              "(tools/setup), or say where it is: --page FOLDER");
}

const PageFiles::File* PageFiles::find(std::string_view path) const {
  const auto found = files_.find(path == "/" ? std::string_view("/index.html") : path);
  return found == files_.end() ? nullptr : &found->second;
}

}  // namespace segue::web
