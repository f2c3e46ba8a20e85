// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/ids.hpp>
#include <segue/type/value.hpp>

#include <segue/base/diagnostic.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Rock's property files: values of a component's properties in sections, of which a task names some, the
/// later ones over the earlier ones. A section begins with a line such as `--- name:outdoor`; what stands
/// before the first one is the section `default`. Internal.
namespace segue::model::detail {

struct PropertySection {
  std::string name;
  type::Value values;  ///< a map
};

/// The sections in their order, those of the same name as one; symbols (`:FAST`) are texts without their
/// colon. Nothing if there are errors.
std::optional<std::vector<PropertySection>> read_property_sections(std::string_view text,
                                                                   const std::string& file,
                                                                   Diagnostics& diagnostics);

/// The property file of a component for networks in `folder`: `config/orogen/COMPONENT.yml` or
/// `config/COMPONENT.yml`, in `folder` or the nearest folder around it.
std::optional<std::filesystem::path> find_property_file(const std::filesystem::path& folder,
                                                        const ComponentName& component);

}  // namespace segue::model::detail
