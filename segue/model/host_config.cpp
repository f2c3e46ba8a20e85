// SPDX-License-Identifier: Apache-2.0
#include <segue/model/host_config.hpp>
#include <segue/model/reader.hpp>

namespace segue::model {

std::optional<HostConfig> read_host_config(std::string_view text, const std::string& file,
                                           Diagnostics& diagnostics) {
  const std::size_t errors_before = diagnostics.error_count();
  const detail::Source source(file, diagnostics);
  const auto root = source.parse(text);
  if (!root) return std::nullopt;
  detail::Fields fields(*root, "the host", source);
  const auto folder = std::filesystem::path(file).parent_path();
  const auto path = [&](std::string_view key) {
    const std::string given = fields.text(key);
    return given.empty() ? std::filesystem::path() : folder / given;
  };
  HostConfig config;
  config.name = fields.name("name");
  config.listen = fields.text("listen");
  config.credentials = path("credentials");
  config.state = path("state");
  config.zygote = fields.texts("zygote");
  for (const std::string& library : config.zygote) {
    detail::check_name(library, "the host: 'zygote' (names, never paths)", *fields.find("zygote"), source);
  }
  fields.finish();
  if (diagnostics.error_count() > errors_before) return std::nullopt;
  return config;
}

std::optional<HostConfig> load_host_config(const std::filesystem::path& file, Diagnostics& diagnostics) {
  const auto text = detail::read_text(file, diagnostics);
  return text ? read_host_config(*text, file.string(), diagnostics) : std::nullopt;
}

}  // namespace segue::model
